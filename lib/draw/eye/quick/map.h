/* map: lookups of quick pictures, for loops over rays. */
#ifndef DRAW_EYE_QUICK_MAP_H
#define DRAW_EYE_QUICK_MAP_H
#include <stdint.h>
#include <string.h>

#include "draw/eye/batch_impl.h"
#include "draw/eye/texels.h"

/* Between low and high, as two instructions. */
SIMD_INLINE float quick_clamp(float x, float low, float high)
{
	x = x > low ? x : low;
	return x < high ? x : high;
}

/* Smoothstep from 0 at lo to 1; inv: 1 over its width. */
SIMD_INLINE float quick_ramp(float lo, float inv, float x)
{
	float t = quick_clamp((x - lo) * inv, 0, 1);
	return t * t * (3 - 2 * t);
}

/* Whether a ray behind the cornea leans so much to the iris' axis (LOOK_LEANS) that relief may hide relief: its first crossing must
 * be searched for. Straighter rays cross once, to 0.04 % of a picture's light. */
SIMD_INLINE bool quick_leans(float vx, float vy, float vz)
{
	return vx * vx + vy * vy > (float)(LOOK_LEANS * LOOK_LEANS) * vz * vz;
}

/* Bilinear height from pairs of neighbours in one word. */
SIMD_INLINE float quick_height_at(const int *map, int n, float per_mm, float x, float y, float *gx, float *gy)
{
	float h = 0.5f * (float)n - 0.5f, top = (float)n - 1.001f, u = x * per_mm + h, v = y * per_mm + h;
	u = quick_clamp(u, 0, top);
	v = quick_clamp(v, 0, top);
	int iu = (int)u, iv = (int)v, stride = SCENE_PAIR_STRIDE(n), at = iv * stride + iu, p = map[at], q = map[at + stride];
	u -= (float)iu;
	v -= (float)iv;
	float a = (float)(int16_t)p, b = (float)(p >> 16), c = (float)(int16_t)q, d = (float)(q >> 16);
	float top_row = a + u * (b - a), low_row = c + u * (d - c);
	*gx = ((b - a) + v * ((d - c) - (b - a))) * (per_mm * SCENE_PAIR_MM);
	*gy = (low_row - top_row) * (per_mm * SCENE_PAIR_MM);
	return (top_row + v * (low_row - top_row)) * SCENE_PAIR_MM;
}

/* Four channels at once: bilinear, where each ray looks into a map: its first texel, and how far on. */
typedef float quick_four __attribute__((vector_size(16), aligned(16)));
struct quick_places {
	int at[BATCH];
	float u[BATCH], v[BATCH];
};

/* n texels across, rows `stride` apart; coordinates times `per` plus `off`, from the first texel's centre. */
SIMD_INLINE void quick_places_of(struct quick_places *restrict p, const float *restrict x, const float *restrict y, float per, float off, int n, int stride, int count)
{
	float top = (float)n - 1.001f;
	SIMD_LOOP
	for (int i = 0; i < count; i++) {
		float u = quick_clamp(x[i] * per + off, 0, top), v = quick_clamp(y[i] * per + off, 0, top);
		int iu = (int)u, iv = (int)v;
		p->at[i] = 4 * (iv * stride + iu);
		p->u[i] = u - (float)iu;
		p->v[i] = v - (float)iv;
	}
}

SIMD_INLINE quick_four quick_read(const float *p)
{
	quick_four c;
	memcpy(&c, p, sizeof c);
	return c;
}

SIMD_INLINE quick_four quick_look_up(const float *map, int stride, const struct quick_places *p, int i)
{
	const float *a = map + p->at[i], *b = a + 4L * stride;
	quick_four s = quick_read(a), t = quick_read(b);
	s += p->u[i] * (quick_read(a + 4) - s);
	t += p->u[i] * (quick_read(b + 4) - t);
	return s + p->v[i] * (t - s);
}

/* Of 16-bit texels, in multiples of their step. With 0x4b00 above it a whole number becomes that number on 2^23, as a float: the
 * sums round to whole steps, which is what the texels are. */
SIMD_INLINE quick_four quick_texel(const struct scene_texels *map, const struct quick_places *p, int i)
{
	typedef uint16_t half __attribute__((vector_size(16)));
	const half high = { 0x4b00, 0x4b00, 0x4b00, 0x4b00, 0x4b00, 0x4b00, 0x4b00, 0x4b00 };
	half a, b;
	const uint16_t *at = map->px + p->at[i];
	memcpy(&a, at, sizeof a);
	memcpy(&b, at + 4L * map->stride, sizeof b);
	quick_four s = (quick_four)__builtin_shufflevector(a, high, 0, 8, 1, 9, 2, 10, 3, 11), t = (quick_four)__builtin_shufflevector(b, high, 0, 8, 1, 9, 2, 10, 3, 11);
	s += p->u[i] * ((quick_four)__builtin_shufflevector(a, high, 4, 12, 5, 13, 6, 14, 7, 15) - s);
	t += p->u[i] * ((quick_four)__builtin_shufflevector(b, high, 4, 12, 5, 13, 6, 14, 7, 15) - t);
	return s + p->v[i] * (t - s) - 8388608.0f;
}

#endif
