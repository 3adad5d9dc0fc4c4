#include "track/clip/apertures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/clip/scale.h"

enum { EYE_INPUTS = 5, ABOUT = 5 };

/* Shares of the usual opening: eyes that are open less are shut; what a lower lid rises by when an eye shuts (of a rendered head, -0.02), and its standard deviation, assumptions; what it leaps by from
 * one frame to the next where it is found wrongly. */
static const double shut = 0.2, rises = 0.05, rises_sigma = 0.1, leaps = 0.05;
static const double few = 20;          // votes of frames less than half open, of which one that is wholly shut has 600: with so many the line between the corners counts as much
static const double line_sigma = 0.2;  // of the usual opening: how far that line is from where lids meet

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

struct vote { double at, weight; };

static int by_height(const void *a, const void *b)
{
	const struct vote *x = a, *y = b;
	return (x->at > y->at) - (x->at < y->at);
}

/* The weighted median: where half of the weight lies below, each vote's spread evenly to the next ones. Sorts. */
static double middle_of(int n, struct vote *v, double weight)
{
	double below = 0;
	qsort(v, (size_t)n, sizeof *v, by_height);
	for (int i = 0; i < n; i++) {
		const double to = below + 0.5 * v[i].weight, from = i ? below - 0.5 * v[i - 1].weight : to;
		if (to >= 0.5 * weight)
			return i && to > from ? v[i - 1].at + (0.5 * weight - from) / (to - from) * (v[i].at - v[i - 1].at) : v[i].at;
		below += v[i].weight;
	}
	return n ? v[n - 1].at : NAN;
}

/* Median of the frames about one. */
static double about(const double *y, long n, long f)
{
	const long from = f < ABOUT ? 0 : f - ABOUT, to = f + ABOUT < n ? f + ABOUT : n - 1;
	return median_known(to - from + 1, y + from);
}

/* Height at which upper and lower margin meet, the same in all frames: on the way there the lower lid hardly moves. Each frame tells it, the better the further the
 * eye is shut. No frame decides by itself: that of a lid which closes fast is often wrong. Of an eye that is never less than half open it is the line between the corners, which lies higher
 * (*sigma): lids that are driven by what was learnt meet there best. Between both it moves smoothly. */
static double meeting(double *sigma, const struct track_result *r, int side, const double *up, const double *low)
{
	double *gap = mem_new((size_t)r->n + 1, sizeof *gap), *line = mem_new((size_t)r->n + 1, sizeof *line), weight = 0, left = 0, closing = 0;
	struct vote *vote = mem_array((size_t)r->n + 1, sizeof *vote);
	int n = 0;
	for (long f = 0; f < r->n; f++) {
		const float(*u)[2] = lid_of(r, f, side, LID_UPPER);
		gap[f] = fabs(low[f] - up[f]);
		line[f] = 0.5 * (u[0][1] + u[r->lid_points - 1][1]);
	}
	const double usual = median_known(r->n, gap), corners = median_known(r->n, line), half = pow(shut * shut + 0.25, -2);
	for (long f = 0; f < r->n; f++) {
		const double open = gap[f] / usual, at = low[f] - rises * gap[f], odd = (low[f] - about(low, r->n, f)) / (leaps * usual), w = pow((shut * shut + open * open) * (1 + odd * odd), -2);
		if (!isfinite(w))
			continue;
		closing += fmax(w - half, 0);
		vote[n++] = (struct vote){ at, w };
		weight += w;
		left += w * gap[f];
	}
	const double told = closing / (closing + few), y = n ? middle_of(n, vote, weight) : corners;
	*sigma = hypot(told * (weight > 0 ? rises_sigma * left / weight : 0), (1 - told) * line_sigma * usual);
	free(gap);
	free(line);
	free(vote);
	return told * y + (1 - told) * corners;
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

static void sigmas(struct track_result *r, int side, int lid, const double *y, double common_px)
{
	const double most = 10;  // of a margin hardly seen
	double *clear = mem_new((size_t)r->n + 1, sizeof *clear), noise = scatter(r->n, y);
	for (long f = 0; f < r->n; f++)
		clear[f] = isfinite(y[f]) ? r->eyes.state[f][side].lid_confidence[lid] : NAN;
	double usual = median_known(r->n, clear);
	for (long f = 0; f < r->n; f++)
		r->aperture_sigma[f][side][lid] = isfinite(y[f]) ? hypot(common_px, noise * fmin(most, fmax(1, usual / fmax(clear[f], 1e-9)))) : NAN;
	free(clear);
}

static void eye(struct track_result *r, int side, double least_px)
{
	double *up = mem_new((size_t)r->n + 1, sizeof *up), *low = mem_new((size_t)r->n + 1, sizeof *low), common;
	double x = column(r, side);
	for (long f = 0; f < r->n; f++) {
		up[f] = height_at(r->lid_points, lid_of(r, f, side, LID_UPPER), x);
		low[f] = height_at(r->lid_points, lid_of(r, f, side, LID_LOWER), x);
	}
	double y = meeting(&common, r, side, up, low);
	r->meeting_sigma[side] = common;
	common = hypot(common, least_px);
	for (long f = 0; f < r->n; f++) {
		double *g = r->g + f * (SIDES * EYE_INPUTS + r->n_au) + side * EYE_INPUTS;
		g[3] = y - up[f];
		g[4] = low[f] - y;
	}
	sigmas(r, side, LID_UPPER, up, common);
	sigmas(r, side, LID_LOWER, low, common);
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
