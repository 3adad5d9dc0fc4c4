/* Multi-scale ridges (Lindeberg 1998), located to a fraction of a texel (Steger 1998). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_ridge.h"
#include "image/mask.h"
#include "image/plane.h"
#include "math/stats.h"
#include "track/wrinkle/impl.h"

/* A line -c exp(-s^2 / 2 w^2) rises by sigma^2 c'' = c sigma^2 w / (w^2 + sigma^2)^1.5: most at sigma = sqrt(2) w, where it
 * is 2 / 3^1.5 of c. */
static const double best_sigma = M_SQRT2, best_rise = 0.3849;
static const double lineness = 0.6;  // curvature along a line against that across
static const double least_px = 0.75; // narrower lines are camera noise

/* Maps of enum cv_derivative. */
struct derived {
	float *of[CV_DERIVATIVES];
};

/* Larger eigenvalue of the second derivatives at a texel, its direction, the other one. */
static void across(float *most, float *least, float n[2], const struct derived *d, long i)
{
	const float dxx = d->of[CV_DXX][i], dxy = d->of[CV_DXY][i], dyy = d->of[CV_DYY][i];
	float half = 0.5f * (dxx - dyy), root = hypotf(half, dxy), mean = 0.5f * (dxx + dyy);
	*most = mean + root;
	*least = mean - root;
	float x = half + root, y = dxy;
	if (half < 0) {
		x = dxy;
		y = root - half;
	}
	float len = hypotf(x, y);
	n[0] = len > 0 ? x / len : 1;
	n[1] = len > 0 ? y / len : 0;
}

/* Threshold of the response: median over the skin plus `significance` times the median absolute deviation. */
static double usual(const struct derived *d, const uint8_t *skin, long area, double sigma2, double significance)
{
	double *room = mem_array((size_t)area / 7 + 1, sizeof *room), *copy = mem_array((size_t)area / 7 + 1, sizeof *copy);
	int n = 0;
	for (long i = 0; i < area; i += 7)
		if (skin[i]) {
			float most, least, dir[2];
			across(&most, &least, dir, d, i);
			room[n++] = sigma2 * (double)most;
		}
	memcpy(copy, room, (size_t)n * sizeof *room);
	double mid = n ? stats_median(n, copy) : 0, out = n ? fmax(mid, 0) + significance * stats_mad(n, room, mid) : INFINITY;
	free(room);
	free(copy);
	return out;
}

/* Strength of the neutral skin's own pattern (hairs, lashes, moles) nearby at that scale. Frames are never registered well
 * enough to cancel it, so a line must be stronger. */
static float *pattern(const struct derived *d, long area, int width, int height, double sigma, double px_per_mm)
{
	float *t = mem_array((size_t)area, sizeof *t);
	const float *dxx = d->of[CV_DXX], *dxy = d->of[CV_DXY], *dyy = d->of[CV_DYY], scale = (float)pow(sigma, 4);
	for (long i = 0; i < area; i++)
		t[i] = scale * (dxx[i] * dxx[i] + 2 * dxy[i] * dxy[i] + dyy[i] * dyy[i]);
	plane_blur(t, width, height, fmax(2 * sigma, px_per_mm));
	for (long i = 0; i < area; i++)
		t[i] = sqrtf(fmaxf(0, t[i]));
	return t;
}

static void take(struct wrinkle_ridges *r, const struct derived *d, const float *pat, const uint8_t *skin, double floor, double sigma,
                 const struct wrinkle_conf *conf)
{
	float least_rise = (float)(best_rise * conf->drop), s2 = (float)(sigma * sigma), share = (float)conf->pattern;
#pragma omp parallel for schedule(static)
	for (int y = 0; y < r->height; y++)
		for (int x = 0; x < r->width; x++) {
			long i = (long)y * r->width + x;
			float most, least, n[2];
			if (!skin[i])
				continue;
			across(&most, &least, n, d, i);
			float rise = s2 * most, limit = fmaxf(least_rise, fmaxf((float)floor, share * pat[i]));
			if (!(rise > (float)wrinkle_follows * limit) || rise <= r->rise[i] || fabsf(least) > (float)lineness * most)
				continue;
			float t = -(d->of[CV_DX][i] * n[0] + d->of[CV_DY][i] * n[1]) / most;
			if (fabsf(t * n[0]) > 0.6f || fabsf(t * n[1]) > 0.6f)
				continue;
			r->rise[i] = rise;
			r->trust[i] = rise / limit;
			r->at[i][0] = (float)x + 0.5f + t * n[0];
			r->at[i][1] = (float)y + 0.5f + t * n[1];
			r->along[i][0] = -n[1];
			r->along[i][1] = n[0];
			r->half[i] = (float)(sigma / best_sigma);
		}
}

/* What is made at every scale: derivatives of both maps and the skin that they do not reach beyond. */
struct room {
	struct derived neutral, change;
	uint8_t *inside;
};

static struct room room_new(long area)
{
	struct room room = { .inside = mem_array((size_t)area, 1) };
	for (int k = 0; k < CV_DERIVATIVES; k++) {
		room.change.of[k] = mem_array((size_t)area, sizeof(float));
		if (k == CV_DXX || k == CV_DXY || k == CV_DYY)  // what its pattern is told by
			room.neutral.of[k] = mem_array((size_t)area, sizeof(float));
	}
	return room;
}

static void room_free(struct room *room)
{
	for (int k = 0; k < CV_DERIVATIVES; k++) {
		free(room->neutral.of[k]);
		free(room->change.of[k]);
	}
	free(room->inside);
}

/* Ridges of one scale: what the neutral frame tells and what the change does are made side by side. */
static bool at_scale(struct wrinkle_ridges *r, struct room *room, double sigma, const float *change, const float *neutral, const uint8_t *skin,
                     const struct wrinkle_ground *g, const struct wrinkle_conf *conf, struct err *err)
{
	const long area = (long)g->width * g->height;
	struct err other = { 0 };
	float *pat = 0;
	double least = 0;
	bool ok = true;
#pragma omp parallel sections
	{
#pragma omp section
		if (cv_ridge(room->neutral.of, neutral, g->width, g->height, sigma, &other))
			pat = pattern(&room->neutral, area, g->width, g->height, sigma, g->px_per_mm);
#pragma omp section
		{
			memcpy(room->inside, skin, (size_t)area);
			mask_grow(room->inside, g->width, g->height, -1.5 * sigma);
			ok = cv_ridge(room->change.of, change, g->width, g->height, sigma, err);
			if (ok)
				least = usual(&room->change, room->inside, area, sigma * sigma, conf->significance);
		}
	}
	if (ok && !pat) {
		*err = other;
		ok = false;
	}
	if (ok)
		take(r, &room->change, pat, room->inside, least, sigma, conf);
	free(pat);
	return ok;
}

bool wrinkle_ridges_find(struct wrinkle_ridges *r, const float *change, const float *neutral, const uint8_t *skin,
                         const struct wrinkle_ground *g, const struct wrinkle_conf *conf, struct err *err)
{
	long area = (long)g->width * g->height;
	*r = (struct wrinkle_ridges){ .width = g->width, .height = g->height };
	r->rise = mem_new((size_t)area, sizeof *r->rise);
	r->trust = mem_new((size_t)area, sizeof *r->trust);
	r->half = mem_new((size_t)area, sizeof *r->half);
	r->at = mem_new((size_t)area, sizeof *r->at);
	r->along = mem_new((size_t)area, sizeof *r->along);
	struct room room = room_new(area);
	bool ok = true;
	for (int k = 0; k < conf->scales && ok; k++) {
		double t = conf->scales > 1 ? (double)k / (conf->scales - 1) : 0;
		double w = g->px_per_mm * conf->width_mm[0] * pow(conf->width_mm[1] / conf->width_mm[0], t), sigma = best_sigma * w;
		if (w >= least_px)
			ok = at_scale(r, &room, sigma, change, neutral, skin, g, conf, err);
	}
	room_free(&room);
	return ok;
}

void wrinkle_ridges_free(struct wrinkle_ridges *r)
{
	free(r->rise);
	free(r->trust);
	free(r->half);
	free(r->at);
	free(r->along);
	*r = (struct wrinkle_ridges){ 0 };
}
