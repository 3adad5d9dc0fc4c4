#include "image/subsurface.h"

#include <math.h>
#include <omp.h>

#include "image/subsurface_level.h"

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

/* How often a Gaussian of that variance (px² of the picture) is halved before it is blurred: what averaging down and
 * interpolating up spread by themselves is (4^l - 1) / 3, and what is left must be worth some taps. -1: narrower than a
 * pixel, the light stays where it is. */
static int level_of(double v)
{
	static const double narrow = 0.6;
	int l = v < narrow ? -1 : 0;
	for (double cell = 4; l >= 0 && l + 1 < SUBSURFACE_LEVELS && (v - (cell - 1) / 3) / cell >= narrow; cell *= 4)
		l++;
	return l;
}

/* Adds one Gaussian, blurred at its own level, to that level's sum. */
static void add(struct subsurface_level *level, int l, double v, double px2, const double weight[3],
                struct subsurface_room *room)
{
	double cell = pow(4, l), own = (v - (cell - 1) / 3) / cell;
	struct subsurface_taps taps;
	subsurface_taps_gauss(&taps, own);
	subsurface_blur(level, &taps, own * cell / px2, weight, room);
}

/* What the levels need: at the top three sums, further down the picture's own four planes, too; and what a blur has at hand. */
static size_t size_of(int width, int height, int deepest)
{
	enum { TOP = 3, BELOW = 7, ROUNDING = 16 };
	size_t n = (size_t)omp_get_max_threads() * subsurface_band_size(width) + ROUNDING;
	for (int l = 0; l <= deepest; l++) {
		size_t stride = (size_t)(width + 7) / 8 * 8;
		n += (l ? BELOW : TOP) * (stride * (size_t)height + ROUNDING) + (stride / SUBSURFACE_PART + 1) * (size_t)height / 4 + ROUNDING;
		width = (width + 1) / 2;
		height = (height + 1) / 2;
	}
	return n;
}

void subsurface_spread(const struct subsurface_picture *p, const struct subsurface_profile *profile, struct subsurface_room *room)
{
	struct subsurface_level level[SUBSURFACE_LEVELS];
	double px2 = p->px_per_mm * p->px_per_mm, stays[3] = { 0 };
	int deepest = 0;
	for (int i = 0; i < profile->n; i++) {
		int l = level_of(profile->variance[i] * px2);
		deepest = l > deepest ? l : deepest;
		for (int c = 0; c < 3 && l < 0; c++)
			stays[c] += profile->weight[i][c];
	}
	subsurface_room_make(room, size_of(p->width, p->height, deepest));
	subsurface_level_top(&level[0], p);
	for (int l = 1; l <= deepest; l++)
		subsurface_level_halve(&level[l], &level[l - 1], p->px_per_mm / (1 << (l - 1)), room);
	for (int l = deepest; l >= 0; l--) {
		for (int i = 0; i < profile->n; i++)
			if (level_of(profile->variance[i] * px2) == l)
				add(&level[l], l, profile->variance[i] * px2, px2, profile->weight[i], room);
		if (l < deepest)
			subsurface_level_join(&level[l], &level[l + 1], p->px_per_mm / (1 << l), l ? 0 : stays, room);
	}
	if (!deepest)
		subsurface_level_give(&level[0], stays);
}
