#include "track/clip/apertures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/clip/scale.h"

enum { EYE_INPUTS = 5 };

static const double shut = 0.3;  // of the usual opening: below it the lids count as meeting

/* Height of a margin where it passes x: NAN where it does not. */
static double height_at(int n, const float (*lid)[2], double x)
{
	for (int i = 0; i + 1 < n; i++) {
		double a = lid[i][0], b = lid[i + 1][0];
		if ((a <= x && b > x) || (b <= x && a > x))
			return lid[i][1] + (x - a) / (b - a) * (lid[i + 1][1] - lid[i][1]);
	}
	return NAN;
}

static double median_known(long n, const double *x)
{
	double *known = mem_new((size_t)n + 1, sizeof *known);
	int m = 0;
	for (long i = 0; i < n; i++)
		if (isfinite(x[i]))
			known[m++] = x[i];
	double mid = m ? stats_median(m, known) : NAN;
	free(known);
	return mid;
}

static const float (*lid_of(const struct track_result *r, long f, int side, int lid))[2]
{
	return (const float(*)[2])r->lids_model + ((f * SIDES + side) * LIDS + lid) * r->lid_points;
}

/* The column midway between the corners, the same in all frames. */
static double column(const struct track_result *r, int side)
{
	double *x = mem_new((size_t)r->n + 1, sizeof *x);
	for (long f = 0; f < r->n; f++) {
		const float(*up)[2] = lid_of(r, f, side, LID_UPPER);
		x[f] = 0.5 * (up[0][0] + up[r->lid_points - 1][0]);
	}
	double mid = median_known(r->n, x);
	free(x);
	return mid;
}

/* Height at which upper and lower margin meet: median over the most closed frames; where the eye never shuts, the line between
 * the corners. usual: the median opening. */
static double meeting(const struct track_result *r, int side, const double *up, const double *low, double *usual)
{
	double *gap = mem_new((size_t)r->n + 1, sizeof *gap), *at = mem_new((size_t)r->n + 1, sizeof *at), least = INFINITY;
	for (long f = 0; f < r->n; f++) {
		gap[f] = low[f] - up[f];
		least = isfinite(gap[f]) ? fmin(least, gap[f]) : least;
	}
	*usual = median_known(r->n, gap);
	bool closes = least < shut * *usual;
	for (long f = 0; f < r->n; f++) {
		const float(*u)[2] = lid_of(r, f, side, LID_UPPER);
		double corners = 0.5 * (u[0][1] + u[r->lid_points - 1][1]);
		at[f] = !closes ? corners : gap[f] <= least + 0.03 * *usual ? 0.5 * (up[f] + low[f]) : NAN;
	}
	double y = median_known(r->n, at);
	free(gap);
	free(at);
	return y;
}

/* How much a margin scatters from frame to frame, px: median size of the second differences, those of frames that stand still left out. */
static double scatter(long n, const double *y)
{
	double *bend = mem_new((size_t)n + 1, sizeof *bend);
	const double normal = 1.4826, differences = sqrt(6);
	for (long f = 0; f < n; f++) {
		bend[f] = f > 0 && f + 1 < n ? fabs(y[f - 1] - 2 * y[f] + y[f + 1]) : NAN;
		bend[f] = bend[f] > 0 ? bend[f] : NAN;
	}
	double mid = median_known(n, bend);
	free(bend);
	return isfinite(mid) ? normal * mid / differences : 0;
}

static void sigmas(struct track_result *r, int side, int lid, const double *y, double least_px)
{
	const double most = 10;  // of a margin hardly seen
	double *clear = mem_new((size_t)r->n + 1, sizeof *clear), noise = scatter(r->n, y);
	for (long f = 0; f < r->n; f++)
		clear[f] = isfinite(y[f]) ? r->eyes.state[f][side].lid_confidence[lid] : NAN;
	double usual = median_known(r->n, clear);
	for (long f = 0; f < r->n; f++)
		r->aperture_sigma[f][side][lid] = isfinite(y[f]) ? hypot(least_px, noise * fmin(most, fmax(1, usual / fmax(clear[f], 1e-9)))) : NAN;
	free(clear);
}

static void eye(struct track_result *r, int side, double least_px)
{
	double *up = mem_new((size_t)r->n + 1, sizeof *up), *low = mem_new((size_t)r->n + 1, sizeof *low), usual;
	double x = column(r, side);
	for (long f = 0; f < r->n; f++) {
		up[f] = height_at(r->lid_points, lid_of(r, f, side, LID_UPPER), x);
		low[f] = height_at(r->lid_points, lid_of(r, f, side, LID_LOWER), x);
	}
	double y = meeting(r, side, up, low, &usual);
	for (long f = 0; f < r->n; f++) {
		double *g = r->g + f * (SIDES * EYE_INPUTS + r->n_au) + side * EYE_INPUTS;
		g[3] = y - up[f];
		g[4] = low[f] - y;
	}
	sigmas(r, side, LID_UPPER, up, least_px);
	sigmas(r, side, LID_LOWER, low, least_px);
	free(up);
	free(low);
}

static void carry(struct track_result *r, const struct track_clip *clip, const struct track_subject *s)
{
	for (long f = 0; f < r->n; f++)
		for (int k = 0; k < SIDES * LIDS; k++)
			for (int i = 0; i < r->lid_points; i++) {
				long at = (f * SIDES * LIDS + k) * r->lid_points + i;
				const double *px = r->eyes.state[f][k / LIDS].lid[k % LIDS][i];
				for (int c = 0; c < 2; c++)
					r->lids[at][c] = r->lids_model[at][c] = (float)px[c];
				if (isfinite(px[0]))
					track_to_model(r->lids_model[at], px, s->opening[k / LIDS].center, r->pose[f], clip);
			}
}

void track_apertures(struct track_result *r, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	int width = SIDES * EYE_INPUTS + r->n_au;
	size_t lids = (size_t)r->n * SIDES * LIDS * (size_t)r->lid_points;
	r->g = mem_new((size_t)r->n * (size_t)width + 1, sizeof *r->g);
	r->aperture_sigma = mem_new((size_t)r->n + 1, sizeof *r->aperture_sigma);
	for (long i = 0; i < r->n * SIDES * LIDS; i++)
		r->aperture_sigma[i / (SIDES * LIDS)][i / LIDS % SIDES][i % LIDS] = NAN;
	r->lids = bulk_new(r->bulk, lids + 1, sizeof *r->lids);
	r->lids_model = bulk_new(r->bulk, lids + 1, sizeof *r->lids_model);
	for (long i = 0; i < r->n * width; i++)
		r->g[i] = NAN;
	for (size_t i = 0; i < lids; i++)
		for (int c = 0; c < 2; c++)
			r->lids[i][c] = r->lids_model[i][c] = NAN;
	if (!r->has_eyes)
		return;
	carry(r, clip, s);
	for (long f = 0; f < r->n; f++)
		for (int e = 0; e < SIDES; e++)
			for (int k = 0; k < 3; k++)
				r->g[f * width + e * EYE_INPUTS + k] = r->eyes.state[f][e].gaze[k] * 180 / M_PI;
	for (int e = 0; e < SIDES; e++)
		if (r->eyes.globe[e].seen)
			eye(r, e, conf->lid_sigma_mm * track_px_per_mm(clip, clip->cam_from_head, s));
}
