/* batch_impl: batches of rays of sight inside the eye, and how loops over them read maps. One array for each coordinate, so that
 * the loops become vector code. Frame: eye, mm. */
#ifndef DRAW_EYE_BATCH_IMPL_H
#define DRAW_EYE_BATCH_IMPL_H
#include "draw/eye/look.h"
#include "draw/eye/scene.h"
#include "draw/smooth.h"
#include "math/simd.h"

enum { BATCH = 256 };

/* Rays of sight inside the eye, and what they meet. */
struct iris_batch {
	int n;
	float fx[BATCH], fy[BATCH], fz[BATCH];  // where the ray starts behind the cornea
	float vx[BATCH], vy[BATCH], vz[BATCH];  // its unit direction
	float px[BATCH], py[BATCH], pz[BATCH];  // where it meets the relief
	float near[BATCH], span[BATCH];         // length in the anterior border layer; in both layers
	float rgb[3][BATCH];                    // light scattered towards the camera; a white plane = 1
};

/* Height of a relief map [n][n][2] at the point (x, y) mm, bilinear, clamped to the map; *gx, *gy: its gradient. per_mm: texels in
 * a mm. */
SIMD_INLINE float relief_at(const float *map, int n, float per_mm, float x, float y, float *gx, float *gy)
{
	float h = 0.5f * (float)n - 0.5f, top = (float)n - 1.001f;
	float u = x * per_mm + h, v = y * per_mm + h;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v, at = 2 * (iv * n + iu);
	u -= (float)iu;
	v -= (float)iv;
	float a = map[at], b = map[at + 2], c = map[at + 2 * n], d = map[at + 2 * n + 2];
	*gx = ((1 - v) * (b - a) + v * (d - c)) * per_mm;
	*gy = ((1 - u) * (c - a) + u * (d - b)) * per_mm;
	return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

/* One channel of a map [n][n][channels], likewise. */
SIMD_INLINE float channel_at(const float *map, int n, float per_mm, float x, float y, int channels, int channel)
{
	float h = 0.5f * (float)n - 0.5f, top = (float)n - 1.001f;
	float u = x * per_mm + h, v = y * per_mm + h;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v, at = channels * (iv * n + iu) + channel;
	u -= (float)iu;
	v -= (float)iv;
	return (1 - v) * ((1 - u) * map[at] + u * map[at + channels])
	       + v * ((1 - u) * map[at + channels * n] + u * map[at + channels * n + channels]);
}

#endif
