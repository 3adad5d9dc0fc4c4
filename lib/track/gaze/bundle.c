#include "track/gaze/bundle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/stats.h"

enum { SHARED = GAZE_GLOBE, FRAMES = 400, EDGES = 48, ROUNDS = 60 };

struct sums {
	double a[SHARED][SHARED], b[SHARED];  // reduced normal equations of the shared unknowns
	double weight, square;
};

struct own {                              // of one frame
	double a[SHARED][SHARED], b[SHARED], cross[SHARED][2], c[2][2], d[2];
	double weight, square;
	double inverse[2][2];
	bool used;
};

/* Normal equations of one frame; dist (may be null) takes the distances. */
static int gather(struct own *own, double dist[EDGES], const struct gaze_frame *frame, const struct gaze_globe *globe,
                  double cut)
{
	int n = 0, step = (frame->n + EDGES - 1) / EDGES;
	double R[3][3];
	*own = (struct own){ 0 };
	gaze_rotation(R, (double[3]){ frame->fick[0], frame->fick[1], 0 });
	for (int i = 0; i < frame->n && n < EDGES; i += step) {
		struct gaze_arc arc;
		const struct gaze_edge *e = &frame->edge[i];
		if (!gaze_arc(&arc, globe, &frame->view, R, frame->fick, e->angle, true))
			continue;
		double s = (e->x - arc.p[0]) * arc.normal[0] + (e->y - arc.p[1]) * arc.normal[1], u = s / cut;
		double w = fabs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
		if (dist)
			dist[n] = fabs(s);
		n++;
		for (int k = 0; k < SHARED; k++) {
			for (int l = 0; l < SHARED; l++)
				own->a[k][l] += w * arc.row[2 + k] * arc.row[2 + l];
			own->b[k] += w * arc.row[2 + k] * s;
			for (int l = 0; l < 2; l++)
				own->cross[k][l] += w * arc.row[2 + k] * arc.row[l];
		}
		for (int k = 0; k < 2; k++) {
			for (int l = 0; l < 2; l++)
				own->c[k][l] += w * arc.row[k] * arc.row[l];
			own->d[k] += w * arc.row[k] * s;
		}
		own->weight += w;
		own->square += w * s * s;
	}
	return n;
}

/* Eliminates the frame's own two unknowns (Schur complement) and adds the rest to the sums. */
static void reduce(struct sums *sums, struct own *own)
{
	double det = own->c[0][0] * own->c[1][1] - own->c[0][1] * own->c[1][0];
	own->used = own->weight > 6 && det > 1e-6 * own->c[0][0] * own->c[1][1];
	if (!own->used)
		return;
	own->inverse[0][0] = own->c[1][1] / det;
	own->inverse[1][1] = own->c[0][0] / det;
	own->inverse[0][1] = own->inverse[1][0] = -own->c[0][1] / det;
	for (int k = 0; k < SHARED; k++) {
		double e[2];
		for (int l = 0; l < 2; l++)
			e[l] = own->cross[k][0] * own->inverse[0][l] + own->cross[k][1] * own->inverse[1][l];
		for (int l = 0; l < SHARED; l++)
			sums->a[k][l] += own->a[k][l] - e[0] * own->cross[l][0] - e[1] * own->cross[l][1];
		sums->b[k] += own->b[k] - e[0] * own->d[0] - e[1] * own->d[1];
	}
	sums->weight += own->weight;
	sums->square += own->square;
}

static double *shared(struct gaze_globe *globe, int k)
{
	return k < 3 ? &globe->center[k] : k == 3 ? &globe->radius : &globe->limbus;
}

/* Gauss-Newton step of all unknowns, with the prior; noise: variance of an edge, px². */
static bool solve(double step[SHARED], struct sums *sums, struct gaze_globe *globe, const struct gaze_globe *start,
                  const double sigma[SHARED], double noise, double cov[SHARED][SHARED])
{
	struct gaze_globe from = *start;
	double a[SHARED][SHARED];
	for (int k = 0; k < SHARED; k++) {
		double tie = noise / (sigma[k] * sigma[k]);
		sums->a[k][k] += tie;
		step[k] = sums->b[k] + tie * (*shared(&from, k) - *shared(globe, k));
	}
	memcpy(a, sums->a, sizeof a);
	if (!chol_solve(SHARED, SHARED, &a[0][0], step))
		return false;
	for (int k = 0; k < SHARED; k++) {
		double e[SHARED] = { 0 };
		e[k] = 1;
		memcpy(a, sums->a, sizeof a);
		chol_solve(SHARED, SHARED, &a[0][0], e);
		for (int l = 0; l < SHARED; l++)
			cov[k][l] = noise * e[l];
	}
	return true;
}

/* Median of the distances. */
static double scale_of(int n, struct gaze_frame *const frame[], const struct gaze_globe *globe)
{
	double *all = mem_array((size_t)n * EDGES, sizeof *all);
	int m = 0;
	for (int i = 0; i < n; i++) {
		struct own own;
		m += gather(&own, all + m, frame[i], globe, 1e9);
	}
	double scale = m ? 1.4826 * stats_median(m, all) : 0;
	free(all);
	return fmax(0.2, scale);
}

/* Radius of the limbus in the first frame, px. */
static double limbus_px(const struct gaze_frame *frame, const struct gaze_globe *globe)
{
	const double(*m)[4] = frame->view.cam_from_head;
	double z = m[2][3];
	for (int k = 0; k < 3; k++)
		z += m[2][k] * globe->center[k];
	return z > 0 ? frame->view.camera.focal_px / z * globe->limbus : 0;
}

/* Number of independent frames: those of one gaze share shading and lids. */
static double distinct(int n, struct gaze_frame *const frame[])
{
	double seen[FRAMES][2], apart = 4 * M_PI / 180;
	int m = 0;
	for (int i = 0; i < n; i++) {
		const double *f = frame[i]->fick;
		int k = 0;
		while (k < m && hypot(f[0] - seen[k][0], f[1] - seen[k][1]) > apart)
			k++;
		if (k == m) {
			seen[m][0] = f[0];
			seen[m++][1] = f[1];
		}
	}
	return m;
}

static bool iterate(struct gaze_globe *globe, struct gaze_bundle_fit *fit, int n, struct gaze_frame *const frame[],
                    const struct gaze_bundle_conf *conf, struct own own[])
{
	struct gaze_globe start = *globe;
	double sigma[SHARED] = { conf->center_sigma, conf->center_sigma, conf->center_sigma, conf->radius_sigma,
		conf->limbus_sigma };
	double moved = 1, same = n / distinct(n, frame);
	for (fit->iterations = 0; fit->iterations < ROUNDS && moved > 1e-4; fit->iterations++) {
		double scale = scale_of(n, frame, globe), step[SHARED];
		struct sums sums = { 0 };
		for (int i = 0; i < n; i++) {
			gather(&own[i], NULL, frame[i], globe, 3 * scale);
			reduce(&sums, &own[i]);
		}
		// Errors round one limbus are correlated (lobes, shading): a frame counts as about three edges.
		double common = hypot(conf->edge_sigma * limbus_px(frame[0], globe), conf->edge_px);
		double noise = sums.weight > 0 ? (sums.square / sums.weight + common * common) * same * EDGES / 3 : 1;
		if (!solve(step, &sums, globe, &start, sigma, fmax(noise, 0.01), fit->cov))
			return false;
		fit->rms = sqrt(sums.square / fmax(1, sums.weight));
		moved = 0;
		for (int k = 0; k < SHARED; k++) {
			*shared(globe, k) += step[k];
			moved = fmax(moved, fabs(step[k]));
		}
		for (int i = 0; i < n; i++) {
			double rest[2];
			for (int l = 0; l < 2; l++) {
				rest[l] = own[i].d[l];
				for (int k = 0; k < SHARED; k++)
					rest[l] -= own[i].cross[k][l] * step[k];
			}
			for (int l = 0; l < 2 && own[i].used; l++)
				frame[i]->fick[l] += own[i].inverse[l][0] * rest[0] + own[i].inverse[l][1] * rest[1];
		}
		if (!(globe->limbus > 1) || !(globe->radius > 1.02 * globe->limbus) || !isfinite(globe->center[0]))
			return false;
	}
	return true;
}

bool gaze_bundle_fit(struct gaze_globe *globe, struct gaze_bundle_fit *fit, int n, struct gaze_frame frame[],
                   const struct gaze_bundle_conf *conf)
{
	int m = n < FRAMES ? n : FRAMES;
	struct gaze_globe start = *globe;
	*fit = (struct gaze_bundle_fit){ 0 };
	if (n < 2)
		return false;
	struct gaze_frame **some = mem_array((size_t)m, sizeof *some);
	struct own *own = mem_array((size_t)m, sizeof *own);
	for (int i = 0; i < m; i++)
		some[i] = &frame[(long)i * n / m];
	bool good = iterate(globe, fit, m, some, conf, own);
	if (!good)
		*globe = start;
	free(some);
	free(own);
	return good;
}

void gaze_bundle_common(double cov[2][2], const struct gaze_frame *frame, const struct gaze_globe *globe, const struct gaze_bundle_fit *fit)
{
	struct own own;
	struct sums none = { 0 };
	double slope[2][SHARED] = { { 0 } };
	gather(&own, NULL, frame, globe, INFINITY);
	reduce(&none, &own);
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < SHARED; k++)
			for (int l = 0; l < 2; l++)
				slope[i][k] -= own.inverse[i][l] * own.cross[k][l];
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++) {
			cov[i][j] = own.used ? 0 : NAN;
			for (int k = 0; k < SHARED; k++)
				for (int l = 0; l < SHARED; l++)
					cov[i][j] += slope[i][k] * fit->cov[k][l] * slope[j][l];
		}
}
