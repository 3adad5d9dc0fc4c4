/* The march from the texels of the map instead of along the rays of sight. Scattered light varies slowly compared with the fibres
 * that the photograph shows: the march is done at every second or fourth texel each way, and only its ratio to the model's colour
 * in the photograph's light is multiplied into the photograph's own texels. Each texel is seen along its own refracted path, so a
 * pixel shows what a march along its ray would have given, up to interpolation between texels. */
#include "draw/eye/march/shade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/colour.h"
#include "draw/eye/levels.h"
#include "draw/eye/march/march.h"
#include "draw/eye/march/paths_flat.h"
#include "draw/eye/own_light.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

struct painter {
	const struct scene *scene;
	const struct scene_level *level;  // that is marched from
	const struct scene_beam *sight;
	const struct scene_beams *beams;
	struct march_tissue tissue;
	int tiles;      // across
	int stride;     // of light
	float *light;   // [level->n][stride][4]
	float through;  // over 0: light times that goes there, not its ratio to the model
};

/* Texel of a tile's ray in a map of n; the edge repeats. */
static long texel(int n, int stride, int tx, int ty, int i)
{
	int x = tx * TILE_SIDE + i % TILE_SIDE, y = ty * TILE_SIDE + i / TILE_SIDE;
	x = x < n ? x : n - 1;
	y = y < n ? y : n - 1;
	return (long)y * stride + x;
}

SIMD_CLONES static void sight_lay(struct iris_batch *b, float way[4][SCENE_WAY], float x, float y, float step)
{
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		float c = (float)(i % TILE_SIDE) + 0.5f, r = (float)(i / TILE_SIDE) + 0.5f, u = c / TILE_SIDE, v = r / TILE_SIDE;
		float w00 = (1 - u) * (1 - v), w10 = u * (1 - v), w01 = (1 - u) * v, w11 = u * v;
		float dx = w00 * way[0][0] + w10 * way[1][0] + w01 * way[2][0] + w11 * way[3][0];
		float dy = w00 * way[0][1] + w10 * way[1][1] + w01 * way[2][1] + w11 * way[3][1];
		float dz = w00 * way[0][2] + w10 * way[1][2] + w01 * way[2][2] + w11 * way[3][2];
		float inv = -1 / sqrtf(dx * dx + dy * dy + dz * dz), z = dz * inv;
		b->px[i] = x + c * step;
		b->py[i] = y + r * step;
		b->vx[i] = dx * inv;
		b->vy[i] = dy * inv;
		b->vz[i] = z > 0.2f ? z : 0.2f;  // flatter, nobody sees it
	}
}

/* Rays of sight that end at a tile's texels; all but their depth. */
static void tile_rays(struct iris_batch *b, const struct painter *p, const struct march_tile *t)
{
	float way[4][SCENE_WAY], side = TILE_SIDE * t->step, plane = (float)p->scene->eye.iris_depth;
	for (int k = 0; k < 4; k++)
		scene_table_at(way[k], p->sight, (float[3]){ t->x + (k & 1 ? side : 0), t->y + (k & 2 ? side : 0), plane }, (float)p->scene->extent);
	b->n = PART;
	sight_lay(b, way, t->x, t->y, t->step);
}

SIMD_CLONES static void rows_put(float *restrict out, long stride, const float (*restrict rgb)[BATCH])
{
	for (int y = 0; y < TILE_SIDE; y++) {
		float *restrict row = out + 4 * y * stride;
		const float *restrict r = rgb[0] + y * TILE_SIDE, *restrict g = rgb[1] + y * TILE_SIDE, *restrict b = rgb[2] + y * TILE_SIDE;
		SIMD_LOOP
		for (int i = 0; i < TILE_SIDE; i++) {
			row[4 * i] = r[i];
			row[4 * i + 1] = g[i];
			row[4 * i + 2] = b[i];
			row[4 * i + 3] = 0;
		}
	}
}

/* Writes the factor of the photograph's colour (draw/eye/colour.h). */
static void tile_put(struct iris_batch *b, const struct painter *p, int tx, int ty)
{
	const struct scene_level *l = p->level;
	bool whole = (tx + 1) * TILE_SIDE <= p->level->n && (ty + 1) * TILE_SIDE <= p->level->n;
	const float *per = p->through > 0 || !l->per_model ? 0 : l->per_model + 3 * PART * ((long)ty * p->tiles + tx);
	for (int i = 0; i < PART && p->through > 0; i++)
		for (int c = 0; c < 3; c++)
			b->rgb[c][i] = fmaxf(p->through * b->rgb[c][i], SCENE_DARK);
	if (per)
		scene_colour_ratio(PART, b->rgb, p->scene, (const float *const[3]){ per, per + PART, per + 2 * PART });
	for (int i = 0; i < PART && per && p->beams->own > 0; i++) {
		float own = scene_own_light_at(p->scene, p->beams->own, b->px[i], b->py[i]);
		for (int c = 0; c < 3; c++)
			b->rgb[c][i] *= own;
	}
	if (whole) {
		rows_put(p->light + 4 * texel(p->level->n, p->stride, tx, ty, 0), p->stride, (const float(*)[BATCH])b->rgb);
		return;
	}
	for (int i = 0; i < PART; i++) {
		float *out = p->light + 4 * texel(p->level->n, p->stride, tx, ty, i);
		for (int c = 0; c < 3; c++)
			out[c] = b->rgb[c][i];
		out[3] = 0;
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
	struct march_tile t = { (float)(tx * TILE_SIDE) * step - extent, (float)(ty * TILE_SIDE) * step - extent, step, tx, ty, 0 };
	if (!tile_seen(s, &t)) {
		for (int i = 0; i < PART && !(p->through > 0); i++)
			memset(p->light + 4 * texel(p->level->n, p->stride, tx, ty, i), 0, 4 * sizeof *p->light);
		return;
	}
	if (p->level->horizon)
		t.horizon = p->level->horizon + (long)ty * p->tiles + tx;
	tile_rays(&b, p, &t);
	scene_scatter_tile(&b, &t, s, p->level, p->beams, &p->tissue);
	tile_put(&b, p, tx, ty);
}

static void paint(const struct painter *p)
{
#pragma omp parallel for schedule(dynamic, 4)
	for (int i = 0; i < p->tiles * p->tiles; i++)
		tile_paint(p, i % p->tiles, i / p->tiles);
}

static void per_model_make(struct scene_level *l)
{
	int tiles = (l->n + TILE_SIDE - 1) / TILE_SIDE;
	free(l->per_model);
	l->per_model = mem_array((size_t)tiles * (size_t)tiles, 3 * PART * sizeof *l->per_model);
	for (int k = 0; k < tiles * tiles; k++)
		for (int i = 0; i < PART; i++)
			for (int c = 0; c < 3; c++)
				l->per_model[(3L * k + c) * PART + i] = 1 / l->model[4 * texel(l->n, l->n, k % tiles, k / tiles, i) + c];
}

void scene_shade_model(struct scene_level *level, const struct scene *s, const double C[3], const struct scene_beams *beams, float through)
{
	struct scene_beam *sight = scene_sight(s, C);
	paint(&(struct painter){ s, level, sight, beams, scene_march_tissue(&s->optics), (level->n + TILE_SIDE - 1) / TILE_SIDE, level->n, level->model, through });
	free(sight);
	per_model_make(level);
}

struct scene_shade scene_shade_flat(const struct scene *s, const struct scene_level *level, const struct scene_lighting *light, const double eye_from_cam[3][3])
{
	return (struct scene_shade){ SCENE_FLAT, SCENE_FLAT, level->per_mm, (float)(SCENE_FLAT / (2 * s->extent)), &level->bare, scene_paths_flat(s, light, eye_from_cam), true };
}

struct scene_shade scene_shade_make(const struct scene *s, const struct scene_level *level, const double C[3], const struct scene_beams *beams)
{
	int k = (int)(level - s->level) + scene_marched(s);
	const struct scene_level *coarse = s->level + (k < s->n_levels ? k : s->n_levels - 1);
	struct scene_beam *sight = scene_sight(s, C);
	struct painter p = { s, coarse, sight, beams, scene_march_tissue(&s->optics), (coarse->n + TILE_SIDE - 1) / TILE_SIDE, coarse->n + 4, 0, 0 };
	p.light = mem_array((size_t)coarse->n * (size_t)p.stride, 4 * sizeof *p.light);
	paint(&p);
	free(sight);
	return (struct scene_shade){ coarse->n, p.stride, level->per_mm, coarse->per_mm, &level->shown, p.light, false };
}
