#include "image/subsurface/subsurface.h"

#include <math.h>
#include <omp.h>

#include "image/subsurface/impl.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

struct subsurface_profile subsurface_skin(double red_mm)
{
	struct subsurface_profile skin = {
		6,
		{ 0.0064, 0.0484, 0.187, 0.567, 1.99, 7.41 },
		{ { 0.233, 0.455, 0.649 }, { 0.1, 0.336, 0.344 }, { 0.118, 0.198, 0 }, { 0.113, 0.007, 0.007 }, { 0.358, 0.004, 0 }, { 0.078, 0, 0 } },
	};
	double mean = 0;
	for (int i = 0; i < skin.n; i++)
		mean += 2 * skin.weight[i][0] * skin.variance[i];
	for (int i = 0; i < skin.n; i++)
		skin.variance[i] *= red_mm * red_mm / mean;
	return skin;
}

/* The level at which a Gaussian of variance v (px² of the picture) is applied. Averaging down and interpolating up l times
 * spread by (4^l - 1) / 3 themselves; what remains must be wide enough for some taps. -1: narrower than a pixel. */
static int level_of(double v)
{
	static const double narrow = 0.6;
	int l = v < narrow ? -1 : 0;
	for (double cell = 4; l >= 0 && l + 1 < SUBSURFACE_LEVELS && (v - (cell - 1) / 3) / cell >= narrow; cell *= 4)
		l++;
	return l;
}

/* Assigns the profile's Gaussians to levels; returns the deepest. One narrower than a pixel is split between the unblurred
 * picture and the unblurred level 1 in proportions that give its variance: halving and interpolating back spread by 1 px². */
static int deal(struct subsurface_level level[SUBSURFACE_LEVELS], double stays[3], const struct subsurface_profile *profile, double px_per_mm)
{
	double px2 = px_per_mm * px_per_mm, halved[3] = { 0 };
	int deepest = 0;
	for (int l = 0; l < SUBSURFACE_LEVELS; l++)
		level[l].texels_per_mm = px_per_mm / (1 << l);
	for (int i = 0; i < profile->n; i++) {
		double v = profile->variance[i] * px2;
		int l = level_of(v);
		for (int c = 0; c < 3 && l < 0; c++) {
			stays[c] += profile->weight[i][c];
			halved[c] += v * profile->weight[i][c];
		}
		if (l >= 0) {
			double cell = pow(4, l);
			deepest = l > deepest ? l : deepest;
			subsurface_gauss_make(&level[l].gauss[level[l].n++], (v - (cell - 1) / 3) / cell, level[l].texels_per_mm, profile->weight[i]);
		}
	}
	for (int c = 0; c < 3 && deepest; c++) {
		level[1].plain[c] = (float)halved[c];
		stays[c] -= halved[c];
	}
	return deepest;
}

void subsurface_spread(const struct subsurface_picture *p, const struct subsurface_profile *profile, struct subsurface_room *room)
{
	struct subsurface_level level[SUBSURFACE_LEVELS] = { 0 };
	double stays[3] = { 0 };
	int deepest = deal(level, stays, profile, p->px_per_mm);
	size_t size = 0;
	for (int l = 0, width = p->width, height = p->height; l <= deepest; l++, width = (width + 1) / 2, height = (height + 1) / 2)
		size += subsurface_level_size(&level[l], width, height, !l);
	subsurface_room_make(room, size + (size_t)omp_get_max_threads() * subsurface_sum_size(level, deepest));
	subsurface_level_fill(level, deepest, p, room);
	if (deepest)
		subsurface_level_halve(level, deepest);
	subsurface_sum(level, deepest, p, stays, room);
}
