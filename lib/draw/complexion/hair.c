/* Hairs on the skin: brows by their darkness over millimetres, lashes and single hairs as thin dark lines. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "image/mask.h"
#include "math/stats.h"

// ln of luminance by which a brow is darker than skin, over brow_mm, and a hair than what is beside it within hair_mm, its grain smoothed
// over grain_mm: pores are 0.1 dark at most.
static const double brow_dark = 0.16, brow_mm = 1.2, hair_dark = 0.25, hair_mm = 0.9, grain_mm = 0.35;
// Radii of an eyeball: brows lie so far above its centre, and no further to the side; lashes no further from it.
static const double brow_low = 0.75, brow_high = 2.6, brow_aside = 2.6, lash_far = 1.75;
static const double brow_wide_mm = 1.5, hair_wide_mm = 0.3, border_mm = 0.35;

/* Running maximum (sign 1) or minimum (-1) over 2 r + 1 along one axis; by van Herk it would be faster, r is some ten texels. */
static void extreme(float *out, const float *in, int side, int r, bool down, float sign)
{
#pragma omp parallel for schedule(static)
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			float best = -INFINITY;
			const int at = down ? y : x, low = at - r < 0 ? 0 : at - r, high = at + r >= side ? side - 1 : at + r;
			for (int k = low; k <= high; k++)
				best = fmaxf(best, sign * in[down ? (long)k * side + x : (long)y * side + k]);
			out[(long)y * side + x] = sign * best;
		}
}

/* The closing of a map by a square of mm. */
static void closing(float *map, const float *weight, const struct complexion *c, double mm)
{
	const int side = c->side, r = (int)fmax(lrint(mm / c->texel_mm), 1);
	const size_t n = (size_t)side * (size_t)side;
	float *a = mem_array(n + 1, sizeof *a);
	for (size_t i = 0; i < n; i++)
		map[i] = weight[i] > 0 ? map[i] : -1e3f;
	extreme(a, map, side, r, false, 1);
	extreme(map, a, side, r, true, 1);
	extreme(a, map, side, r, false, -1);
	extreme(map, a, side, r, true, -1);
	free(a);
}

/* 0: where hairs are not looked for; 1 lashes' skin; 2 brows'. */
static int zone(const struct complexion *c, const float x[3])
{
	int found = 0;
	for (int s = 0; s < 2; s++) {
		const double across = ((double)x[0] - c->eye[s][0]) / c->radius, up = ((double)x[1] - c->eye[s][1]) / c->radius;
		if (up > brow_low && up < brow_high && fabs(across) < brow_aside)
			found = 2;
		else if (hypot(across, up) < lash_far && found < 1)
			found = 1;
	}
	return found;
}

bool complexion_shave(float *weight, uint8_t *brow, const float (*ln)[3], const struct complexion *c, struct err *err)
{
	const int side = c->side;
	const size_t n = (size_t)side * (size_t)side;
	float *grey = mem_array(n + 1, sizeof *grey), *wide = mem_array(n + 1, sizeof *wide);
	double *some = mem_array(n / 16 + 2, sizeof *some);
	int many = 0;
	for (size_t i = 0; i < n; i++) {
		grey[i] = (float)complexion_luminance(ln[i]);
		if (i % 16 == 0 && weight[i] > 0)
			some[many++] = (double)grey[i];
	}
	const double skin = stats_median(many, some);
	uint8_t *hair = mem_new(n + 1, 1), *none = mem_new(n + 1, 1);
	bool ok = complexion_blur(wide, 0, grey, weight, 1, brow_mm, c, err);
	float *hollow = mem_array(n + 1, sizeof *hollow);
	ok = ok && complexion_blur(hollow, 0, grey, weight, 1, grain_mm, c, err);
	closing(hollow, weight, c, hair_mm);
	for (size_t i = 0; i < n && ok; i++) {
		float x[3];
		none[i] = !(weight[i] > 0);
		const int at = !none[i] && complexion_place(x, c, (long)i) ? zone(c, x) : 0;
		hair[i] = at == 1 && (double)(hollow[i] - grey[i]) > hair_dark;
		brow[i] = at == 2 && (double)wide[i] < skin - brow_dark;
	}
	mask_grow(brow, side, side, brow_wide_mm / c->texel_mm);
	mask_grow(hair, side, side, hair_wide_mm / c->texel_mm);
	mask_grow(none, side, side, border_mm / c->texel_mm);
	for (size_t i = 0; i < n; i++)
		if (brow[i] || hair[i] || none[i])
			weight[i] = 0;
	free(grey);
	free(wide);
	free(some);
	free(hollow);
	free(hair);
	free(none);
	return ok;
}
