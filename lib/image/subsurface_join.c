/* From a level of the pyramid to the one above: bilinear, over the four texels as far as their depth is the pixel's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/subsurface_level.h"
#include "math/simd.h"

/* A row of the level below as the row above sees it: of each of its texels the nearer one and the farther one. */
struct seen {
	float *near[4], *far[4];  // r, g, b, z
};

SIMD_CLONES static void widen(float *restrict near, float *restrict far, const float *restrict in, int n)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		near[2 * i] = in[i];
		near[2 * i + 1] = in[i];
	}
	SIMD_LOOP
	for (int i = 1; i < n; i++) {
		far[2 * i - 1] = in[i];
		far[2 * i] = in[i - 1];
	}
	far[0] = in[0];
	far[2 * n - 1] = in[n - 1];
}

/* The last rows seen: of any three neighbours each has a place of its own. */
struct views {
	struct seen seen[3];
	int row[3];
};

static const struct seen *see(struct views *v, const struct subsurface_level *below, int y)
{
	int row = y < 0 ? 0 : y < below->height ? y : below->height - 1, place = row % 3;
	size_t at = (size_t)row * (size_t)below->stride;
	struct seen *s = &v->seen[place];
	for (int k = 0; k < 4 && v->row[place] != row; k++)
		widen(s->near[k], s->far[k], (k < 3 ? below->sum[k] : below->z) + at, below->width);
	v->row[place] = row;
	return s;
}

/* A texel of the level below: its share as far as its depth is this one's; a trace of it whatever its depth, where all
 * four lie elsewhere. */
SIMD_INLINE float share(float z, float there, float inv, float part)
{
	float d = z - there, f = 1 - d * d * inv;
	f = (f > 0 ? f : 0) + 1e-4f;
	return there > 0 ? part * f : 0;
}

struct row {
	const float *z;
	float *out[3], keep[3];
	int n;
};

/* out = keep out + what comes from below, where there is skin. a: the nearer row of the level below. */
SIMD_CLONES static void join_row(const struct row *row, const struct seen *a, const struct seen *b, float inv)
{
	const float *restrict z = row->z, *restrict za = a->near[3], *restrict zb = a->far[3], *restrict zc = b->near[3], *restrict zd = b->far[3];
	float *restrict r = row->out[0], *restrict g = row->out[1], *restrict blue = row->out[2];
	const float *restrict ra = a->near[0], *restrict rb = a->far[0], *restrict rc = b->near[0], *restrict rd = b->far[0];
	const float *restrict ga = a->near[1], *restrict gb = a->far[1], *restrict gc = b->near[1], *restrict gd = b->far[1];
	const float *restrict ba = a->near[2], *restrict bb = a->far[2], *restrict bc = b->near[2], *restrict bd = b->far[2];
	float kr = row->keep[0], kg = row->keep[1], kb = row->keep[2];
	SIMD_LOOP
	for (int i = 0; i < row->n; i++) {
		float p = share(z[i], za[i], inv, 9), q = share(z[i], zb[i], inv, 3), s = share(z[i], zc[i], inv, 3), t = share(z[i], zd[i], inv, 1);
		float all = (p + q) + (s + t), each = 1 / (all > 0 ? all : 1);
		float red = kr * r[i] + ((p * ra[i] + q * rb[i]) + (s * rc[i] + t * rd[i])) * each;
		float green = kg * g[i] + ((p * ga[i] + q * gb[i]) + (s * gc[i] + t * gd[i])) * each;
		float b_ = kb * blue[i] + ((p * ba[i] + q * bb[i]) + (s * bc[i] + t * bd[i])) * each;
		r[i] = z[i] > 0 ? red : r[i];
		g[i] = z[i] > 0 ? green : g[i];
		blue[i] = z[i] > 0 ? b_ : blue[i];
	}
}

void subsurface_level_join(struct subsurface_level *l, const struct subsurface_level *below, double texels_per_mm,
                           const double stays[3], struct subsurface_room *room)
{
	// At 60 degrees a surface falls by 1.7 texels in one; the farthest of the four is 2.1 off.
	float inv = (float)(texels_per_mm * texels_per_mm / 36);
	int stride = (l->width + 7) / 8 * 8;
	for (int c = 0; c < 3 && !stays; c++)
		if (!l->sum[c]) {
			l->sum[c] = subsurface_room_take(room, (size_t)stride * (size_t)l->height);
			memset(l->sum[c], 0, (size_t)stride * (size_t)l->height * sizeof *l->sum[c]);
		}
	if (stays && l->sum[0])
		subsurface_level_give(l, stays);
#pragma omp parallel
	{
		size_t wide = 2 * (size_t)below->width;
		float *buffer = mem_array(24 * wide, sizeof *buffer);
		struct views views = { .row = { -1, -1, -1 } };
		for (int k = 0; k < 24; k++)
			*(k % 2 ? &views.seen[k / 8].near[k / 2 % 4] : &views.seen[k / 8].far[k / 2 % 4]) = buffer + (size_t)k * wide;
#pragma omp for schedule(static)
		for (int y = 0; y < l->height; y++) {
			struct row row = { .z = l->z + (size_t)y * (size_t)l->stride, .n = l->width };
			for (int c = 0; c < 3; c++) {
				row.out[c] = stays ? l->rgb[c] + (size_t)y * (size_t)l->stride : l->sum[c] + (size_t)y * (size_t)stride;
				row.keep[c] = stays && !l->sum[0] ? (float)stays[c] : 1;
			}
			const struct seen *near = see(&views, below, y / 2), *far = see(&views, below, y % 2 ? y / 2 + 1 : y / 2 - 1);
			join_row(&row, near, far, inv);
		}
		free(buffer);
	}
}
