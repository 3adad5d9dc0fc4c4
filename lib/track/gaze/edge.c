#include "track/gaze/edge.h"

#include <math.h>
#include <string.h>

#include "math/chol.h"
#include "math/stats.h"

enum { PROFILE_MAX = 256 };

/* The strongest rise of a profile; cumulative sums give the means on both sides by look-ups. Returns false at the profile's
 * ends. */
static bool best_step(double *at, double *rise, int m, const double v[], int half)
{
	double sum[PROFILE_MAX + 1] = { 0 }, score[PROFILE_MAX];
	for (int i = 0; i < m; i++)
		sum[i + 1] = sum[i] + v[i];
	int best = -1;
	for (int i = half; i <= m - half; i++) {
		score[i] = ((sum[i + half] - sum[i]) - (sum[i] - sum[i - half])) / half;
		if (best < 0 || score[i] > score[best])
			best = i;
	}
	if (best <= half || best >= m - half)
		return false;
	double l = score[best - 1], c = score[best], r = score[best + 1], bend = l - 2 * c + r;
	*at = best + (bend < 0 ? 0.5 * (l - r) / bend : 0);
	*rise = c;
	return true;
}

int gaze_edges(struct gaze_edge edge[GAZE_ARCS_MAX], const struct luma *luma, const struct gaze_globe *globe,
               const struct gaze_view *view, const double fick[2], const struct gaze_search *search)
{
	int n = 0;
	// One sample a pixel, fewer where the eye is so large that the profile would not fit.
	double step = fmax(1, 2 * (search->range + search->half) / (PROFILE_MAX - 4));
	int half = (int)fmax(1, lround(search->half / step)), m = 2 * ((int)ceil(search->range / step) + half) + 1;
	double R[3][3];
	gaze_rotation(R, (double[3]){ fick[0], fick[1], 0 });
	for (int i = 0; i < search->arcs; i++) {
		struct gaze_arc arc;
		double angle = 2 * M_PI * (i + 0.5) / search->arcs, v[PROFILE_MAX], at, rise;
		if (!gaze_arc(&arc, globe, view, R, fick, angle, false) || (search->seen && !search->seen(search->ctx, arc.p)))
			continue;
		double far = m / 2.0 * step;
		double lo_x = arc.p[0] - far * arc.normal[0], lo_y = arc.p[1] - far * arc.normal[1];
		double hi_x = arc.p[0] + far * arc.normal[0], hi_y = arc.p[1] + far * arc.normal[1];
		if (fmin(lo_x, hi_x) < 0 || fmin(lo_y, hi_y) < 0 || fmax(lo_x, hi_x) > luma->width
		    || fmax(lo_y, hi_y) > luma->height)
			continue;
		for (int k = 0; k < m; k++)
			v[k] = luma_at(luma, lo_x + (k + 0.5) * step * arc.normal[0], lo_y + (k + 0.5) * step * arc.normal[1]);
		if (!best_step(&at, &rise, m, v, half) || rise < search->least)
			continue;
		double x = lo_x + at * step * arc.normal[0], y = lo_y + at * step * arc.normal[1];
		if (search->seen && !search->seen(search->ctx, (double[2]){ x, y }))
			continue;
		edge[n++] = (struct gaze_edge){ (float)angle, (float)x, (float)y, (float)rise };
	}
	return n;
}

enum { FREE = 3 };  // h, v, radius of the circle

struct normal_system {
	double a[FREE][FREE], b[FREE], weight, square;
	double cos2, sin2, cos1, sin1;
};

static void add_row(struct normal_system *sys, const struct gaze_arc *arc, double s, double w, double angle)
{
	double row[FREE] = { arc->row[GAZE_H], arc->row[GAZE_V], arc->row[GAZE_LIMBUS] };
	for (int i = 0; i < FREE; i++) {
		for (int j = 0; j < FREE; j++)
			sys->a[i][j] += w * row[i] * row[j];
		sys->b[i] += w * row[i] * s;
	}
	sys->weight += w;
	sys->square += w * s * s;
	sys->cos2 += w * cos(2 * angle);
	sys->sin2 += w * sin(2 * angle);
	sys->cos1 += w * cos(angle);
	sys->sin1 += w * sin(angle);
}

/* Statistics of the fit from its last step. */
static void describe(struct gaze_fit *fit, const struct normal_system *sys, double noise, int n)
{
	fit->rms = sqrt(sys->square / sys->weight);
	double one = hypot(sys->cos1, sys->sin1) / sys->weight, two = hypot(sys->cos2, sys->sin2) / sys->weight;
	fit->span = fmax(0, 1 - fmax(one, two * one));
	for (int k = 0; k < 2; k++) {
		double e[FREE] = { k == 0, k == 1, 0 }, a[FREE][FREE];
		memcpy(a, sys->a, sizeof a);
		chol_solve(FREE, FREE, &a[0][0], e);
		// Errors of neighbouring edges are correlated (lobes and shading of the limbus): all count as about three.
		fit->cov[0][k] = n / 3.0 * noise * e[0];
		fit->cov[1][k] = n / 3.0 * noise * e[1];
	}
}

static bool one_step(struct gaze_fit *fit, struct gaze_globe *globe, double *shift, int n,
                     const struct gaze_edge edge[], const struct gaze_view *view, double bias_sigma, double *scale,
                     double limbus0)
{
	struct gaze_arc arc[GAZE_ARCS_MAX];
	double s[GAZE_ARCS_MAX], copy[GAZE_ARCS_MAX];
	struct normal_system sys = { 0 };
	double R[3][3];
	gaze_rotation(R, (double[3]){ fit->fick[0], fit->fick[1], 0 });
	for (int i = 0; i < n; i++) {
		if (!gaze_arc(&arc[i], globe, view, R, fit->fick, edge[i].angle, true))
			return false;
		s[i] = (edge[i].x - arc[i].p[0]) * arc[i].normal[0] + (edge[i].y - arc[i].p[1]) * arc[i].normal[1];
		copy[i] = fabs(s[i]);
	}
	// Half of the edges may be lids: the scale is estimated from the better part.
	double spread = 1.4826 * stats_median(n, copy);
	*scale = fmax(0.3, fmin(*scale, spread));
	double cut = 4.7 * *scale;
	for (int i = 0; i < n; i++) {
		double u = s[i] / cut, w = fabs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
		if (w > 0)
			add_row(&sys, &arc[i], s[i], w, edge[i].angle);
	}
	fit->inliers = sys.weight;
	if (!(sys.weight > 6))
		return false;
	double noise = fmax(sys.square / sys.weight, 0.01), tie = noise / (bias_sigma * bias_sigma);
	sys.a[2][2] += tie;
	sys.b[2] += tie * (limbus0 - globe->limbus);
	double a[FREE][FREE], b[FREE];
	memcpy(a, sys.a, sizeof a);
	memcpy(b, sys.b, sizeof b);
	if (!chol_solve(FREE, FREE, &a[0][0], b))
		return false;
	fit->fick[0] += b[0];
	fit->fick[1] += b[1];
	globe->limbus += b[2];
	*shift = fmax(fabs(b[0]), fabs(b[1]));
	describe(fit, &sys, noise, n);
	return true;
}

bool gaze_fit_edges(struct gaze_fit *fit, int n, const struct gaze_edge edge[], const struct gaze_globe *globe,
                    const struct gaze_view *view, double bias_sigma)
{
	struct gaze_globe own = *globe;
	double scale = 1e9, shift = 1;
	if (n < 8)
		return false;
	for (int k = 0; k < 12 && shift > 1e-6; k++)
		if (!one_step(fit, &own, &shift, n, edge, view, bias_sigma, &scale, globe->limbus))
			return false;
	fit->bias = own.limbus - globe->limbus;
	return isfinite(fit->fick[0]) && isfinite(fit->fick[1]) && fabs(fit->fick[0]) < 1.5 && fabs(fit->fick[1]) < 1.5;
}
