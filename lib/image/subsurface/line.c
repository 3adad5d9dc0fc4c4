/* A Gaussian along a line with depth weights: exp(-dz² / 2v) is approximated by (1 - dz² / 8v)^4, 0 beyond, good to 0.02. */
#include "image/subsurface/impl.h"
#include "math/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

/* The loop for one width of vectors: defines a function `name` of a line, a Gaussian and a number of channels. root and fall
 * hold fourth roots, so that one fourth power gives weight times depth weight. */
#define TAP(name, lanes, mask)                                                                                  \
	typedef float lanes __attribute__((vector_size(sizeof(mask)), aligned(4)));                                 \
	SIMD_INLINE void name(const struct subsurface_line *l, const struct subsurface_gauss *g, int channels)      \
	{                                                                                                           \
		const float *restrict z = l->z, *restrict in[3] = { l->in[0], l->in[1], l->in[2] };                     \
		const float *restrict root = g->root + g->radius, *restrict fall = g->fall + g->radius;                 \
		const long step = l->step, z_step = l->z_step;                                                          \
		const int from = l->from, to = l->to;                                                                   \
		const lanes zero = { 0 };                                                                               \
		for (int x = 0; x < l->n; x += (int)(sizeof(lanes) / sizeof *z)) {                                      \
			lanes here = *(const lanes *)(z + x), sum[3] = { zero, zero, zero }, all = zero;                    \
			for (int k = from; k <= to; k++) {                                                                  \
				lanes dz = *(const lanes *)(z + x + k * z_step) - here, f = root[k] - dz * dz * fall[k];        \
				f = (lanes)((mask)f & (f > 0));                                                                 \
				f *= f;                                                                                         \
				f *= f;                                                                                         \
				all += f;                                                                                       \
				for (int c = 0; c < channels; c++)                                                              \
					sum[c] += f * *(const lanes *)(in[c] + x + k * step);                                       \
			}                                                                                                   \
			all = 1 / all; /* the middle one is always there */                                                 \
			for (int c = 0; c < channels; c++) {                                                                \
				lanes *out = (lanes *)(l->out[c] + x), now = sum[c] * (all * l->gain[c]);                       \
				*out = l->adds ? *out + now : now;                                                              \
			}                                                                                                   \
		}                                                                                                       \
	}

typedef int mask_8 __attribute__((vector_size(32)));
typedef int mask_16 __attribute__((vector_size(64)));
_Static_assert(SUBSURFACE_ROUNDING % (sizeof(mask_16) / sizeof(int)) == 0, "lines are of whole vectors");

TAP(tap_8, lanes_8, mask_8)
TAP(tap_16, lanes_16, mask_16)

SIMD_CLONES static void line_8(const struct subsurface_line *l, const struct subsurface_gauss *g)
{
	if (l->channels == 1)
		tap_8(l, g, 1);
	else if (l->channels == 2)
		tap_8(l, g, 2);
	else
		tap_8(l, g, 3);
}

SIMD_WIDE static void line_16(const struct subsurface_line *l, const struct subsurface_gauss *g)
{
	if (l->channels == 1)
		tap_16(l, g, 1);
	else if (l->channels == 2)
		tap_16(l, g, 2);
	else
		tap_16(l, g, 3);
}

void subsurface_line(const struct subsurface_line *l, const struct subsurface_gauss *g)
{
	SIMD_IS_WIDE ? line_16(l, g) : line_8(l, g);
}
