/* The march from the texels of the map instead of along the rays of sight. Light in tissue is smooth against the fibres that
 * the photograph shows: the march is done at every second texel each way, and only its ratio to what the model showed in the
 * photograph's light is multiplied into the photograph's own texels. Sight comes to each texel by its own way through the
 * cornea; so a picture's pixel sees just what a march along its ray would have made, up to what lies between texels. */
#include "eye/scene_march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_meet.c
#endif

struct painter {
	const struct scene *scene;
	const struct scene_level *level;  // that is marched from
	const struct scene_beam *sight;
	const struct scene_beams *beams;
	int tiles;     // across
	bool flat;
	float *ratio;  // [level->n][level->n][4]
};

/* Rays of sight that end at a tile's texels. */
static void tile_rays(struct iris_batch *b, const struct painter *p, const struct march_tile *t, int tx, int ty)
{
	const struct scene_level *l = p->level;
	float extent = (float)p->scene->extent, way[4][SCENE_WAY], side = TILE_SIDE * t->step;
	for (int k = 0; k < 4; k++)
		scene_table_at(way[k], p->sight, (float[3]){ t->x + (k & 1 ? side : 0), t->y + (k & 2 ? side : 0), (float)p->scene->eye.iris_depth }, extent);
	b->n = PART;
	for (int i = 0; i < PART; i++) {
		int x = tx * TILE_SIDE + i % TILE_SIDE, y = ty * TILE_SIDE + i / TILE_SIDE;
		x = x < l->n ? x : l->n - 1;
		y = y < l->n ? y : l->n - 1;
		b->px[i] = ((float)x + 0.5f) * t->step - extent;
		b->py[i] = ((float)y + 0.5f) * t->step - extent;
		b->pz[i] = (float)p->scene->eye.iris_depth - l->relief[2 * ((long)y * l->n + x)];
		float u = ((float)(i % TILE_SIDE) + 0.5f) / TILE_SIDE, v = ((float)(i / TILE_SIDE) + 0.5f) / TILE_SIDE, d[3], n = 0;
		for (int c = 0; c < 3; c++) {
			d[c] = (1 - v) * ((1 - u) * way[0][c] + u * way[1][c]) + v * ((1 - u) * way[2][c] + u * way[3][c]);
			n += d[c] * d[c];
		}
		n = -1 / sqrtf(n);
		b->vx[i] = d[0] * n;
		b->vy[i] = d[1] * n;
		b->vz[i] = fmaxf(d[2] * n, 0.2f);  // flatter, nobody sees it
	}
}

/* What the photograph's colour is to be multiplied by: see scene_colour.c. */
static void tile_put(const struct iris_batch *b, const struct painter *p, int tx, int ty)
{
	int n = p->level->n;
	for (int i = 0; i < PART; i++) {
		int x = tx * TILE_SIDE + i % TILE_SIDE, y = ty * TILE_SIDE + i / TILE_SIDE;
		if (x >= n || y >= n)
			continue;
		long at = 4 * ((long)y * n + x);
		float rgb[3] = { b->rgb[0][i], b->rgb[1][i], b->rgb[2][i] };
		float cover[3] = { 1, 1, 1 };
		if (p->level->model)
			scene_colour_ratio(rgb, p->scene, p->level->model + at);
		else
			scene_pupil(cover, p->scene, b->px[i], b->py[i], 0.5f / p->level->per_mm);
		for (int c = 0; c < 3; c++)
			rgb[c] *= cover[c];
		memcpy(p->ratio + at, rgb, sizeof rgb);
	}
}

static bool tile_seen(const struct scene *s, const struct march_tile *t)
{
	float half = 0.5f * TILE_SIDE * t->step, x = t->x + half, y = t->y + half, reach = 1.5f * half + 0.1f;
	float in = hypotf(x - (float)s->pupil[0], y - (float)s->pupil[1]) + reach;
	return in > (float)s->pupil[2] && hypotf(x, y) - reach < 1.06f * (float)s->limbus[0];
}

static void tile_paint(const struct painter *p, int tx, int ty)
{
	const struct scene *s = p->scene;
	struct iris_batch b;
	float step = 1 / p->level->per_mm, extent = (float)s->extent;
	struct march_tile t = { (float)(tx * TILE_SIDE) * step - extent, (float)(ty * TILE_SIDE) * step - extent, step, 0 };
	if (!tile_seen(s, &t))
		return;
	if (p->level->horizon)
		t.horizon = (const float(*)[PART])p->level->horizon + (long)(ty * p->tiles + tx) * HORIZONS;
	tile_rays(&b, p, &t, tx, ty);
	if (p->flat)
		scene_flat_tile(&b, &t, s, p->beams);
	else
		scene_scatter_tile(&b, &t, s, p->level, p->beams);
	tile_put(&b, p, tx, ty);
}

/* A row of the finer level between two rows of the coarser one, at a quarter and three quarters. */
SIMD_CLONES static void compose_row(float *restrict out, const float *restrict colour, const float *restrict a, const float *restrict b,
                                    float *restrict row, int n, int coarse)
{
	SIMD_LOOP
	for (int i = 0; i < 4 * coarse; i++)
		row[i] = 0.75f * a[i] + 0.25f * b[i];
	for (int x = 0; x < n; x++) {
		int near = x / 2 < coarse ? x / 2 : coarse - 1, far = near + (x & 1 ? 1 : -1);
		far = far < 0 ? 0 : far < coarse ? far : coarse - 1;
		for (int c = 0; c < 4; c++)
			out[4 * x + c] = colour[4 * x + c] * (0.75f * row[4 * near + c] + 0.25f * row[4 * far + c]);
	}
}

static void compose(struct scene_shade *out, const struct scene_level *fine, const float *ratio, int coarse, float detail)
{
#pragma omp parallel for schedule(static)
	for (int y = 0; y < fine->n; y++) {
		float row[4 * coarse], weak[detail < 1 ? 4 * fine->n : 1];
		const float *colour = fine->shown + 4L * y * fine->n;
		for (int i = 0; i < 4 * fine->n && detail < 1; i++)
			weak[i] = powf(colour[i], detail);
		int near = y / 2 < coarse ? y / 2 : coarse - 1, far = near + (y & 1 ? 1 : -1);
		far = far < 0 ? 0 : far < coarse ? far : coarse - 1;
		compose_row(out->rgba + 4L * y * fine->n, detail < 1 ? weak : colour, ratio + 4L * near * coarse,
		            ratio + 4L * far * coarse, row, fine->n, coarse);
	}
}

struct scene_shade scene_shade_make(const struct scene *s, const struct scene_level *level, const double C[3], bool flat,
                                    const struct scene_beams *beams)
{
	const struct scene_level *coarse = level + 1;
	struct painter p = { s, coarse, scene_sight(s, C), beams, (coarse->n + TILE_SIDE - 1) / TILE_SIDE, flat, 0 };
	struct scene_shade out = { level->n, level->per_mm, 0 };
	p.ratio = mem_new((size_t)coarse->n * (size_t)coarse->n, 4 * sizeof *p.ratio);
#pragma omp parallel for schedule(dynamic, 4)
	for (int i = 0; i < p.tiles * p.tiles; i++)
		tile_paint(&p, i % p.tiles, i / p.tiles);
	if (!level->model) {  // nothing to multiply into
		out.n = coarse->n;
		out.per_mm = coarse->per_mm;
		out.rgba = p.ratio;
	} else {
		out.rgba = mem_array((size_t)level->n * (size_t)level->n, 4 * sizeof *out.rgba);
		compose(&out, level, p.ratio, coarse->n, (float)s->conf.detail);
		free(p.ratio);
	}
	free((void *)p.sight);
	return out;
}
