/* Hairs before an eye and the skin about it, as light from one direction has them: a map of their optical depth, perpendicular to it, and of where along it
 * they are. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/face/impl.h"
#include "draw/face/sky.h"
#include "math/vec.h"

static const float reach[2] = { 1.2f, 2.8f };  // of the globe's radius: the eye; brows, too
static const float cell_mm[2] = { 0.15f, 0.3f };  // on an eyeball of 12 mm radius
static const float apart_mm = 0.3f;   // behind hairs by less than that they shade a place by part
static const float lifted_mm = 0.6f;  // hairs that lie on skin are nearer to it than its facets are to each other: so much they are taken to be before it
static const float seen_lit = 0.5f;   // of the shade of such hairs: what is seen between them is what light from before comes to, too
static const float step = 0.4f;       // between points of a hair, of their shadows' half width
static const float widest = 0.4f;     // tangent of half the angle between directions, at most

struct plane {
	float across[3], up[3], dir[3];
	float weight;   // the light's luminance
	float spread;   // tangent of half the angle to the nearest other direction
	float (*depth)[2];   // [cells][cells]; and that times where, mm from the globe's middle towards the light
};

struct portrait_fringe {
	float center[3], radius, cell;  // mm
	int n, cells;
	struct plane *plane;
};

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void plane_make(struct plane *plane, int cells, int k, int n, const struct envmap_light light[])
{
	const float *d = light[k].dir;
	const struct portrait_fan frame = portrait_fan_of(d);
	float nearest = -1;
	memcpy(plane->dir, frame.normal, sizeof plane->dir);
	memcpy(plane->across, frame.across, sizeof plane->across);
	memcpy(plane->up, frame.up, sizeof plane->up);
	plane->weight = 0.2126f * light[k].rgb[0] + 0.7152f * light[k].rgb[1] + 0.0722f * light[k].rgb[2];
	for (int i = 0; i < n; i++)
		nearest = i == k ? nearest : fmaxf(nearest, dot(d, light[i].dir));
	plane->spread = fminf(sqrtf(fmaxf(1 - nearest, 0) / (1 + nearest)), widest);
	plane->depth = mem_new((size_t)cells * (size_t)cells, sizeof *plane->depth);
}

/* Half the width, in cells, of the shadow of a place of a hair: the further that is from the globe, the softer, if it does not lie on skin. */
static float softness(const struct portrait_fringe *f, const struct plane *plane, const float off[3], bool lies)
{
	const float u = dot(off, plane->across), v = dot(off, plane->up), ground2 = f->radius * f->radius - u * u - v * v;
	const float above = lies ? 0 : fmaxf(dot(off, plane->dir) - (ground2 > 0 ? sqrtf(ground2) : 0), 0);
	return 1.5f + plane->spread * above / f->cell;
}

/* A piece of a hair, of that area perpendicular to the light, as a tent round the place of its shadow. */
static void put(const struct portrait_fringe *f, const struct plane *plane, const float off[3], float area, float wide, float lifted)
{
	const float half = 0.5f * (float)f->cells, i = dot(off, plane->across) / f->cell + half, j = dot(off, plane->up) / f->cell + half, s = dot(off, plane->dir) + lifted;
	const float height = area / (f->cell * f->cell * wide * wide);
	const int x0 = (int)fmaxf(ceilf(i - wide), 0), x1 = (int)fminf(floorf(i + wide), (float)(f->cells - 1));
	const int y0 = (int)fmaxf(ceilf(j - wide), 0), y1 = (int)fminf(floorf(j + wide), (float)(f->cells - 1));
	for (int b = y0; b <= y1; b++)
		for (int a = x0; a <= x1; a++) {
			const float more = height * (1 - fabsf((float)a - i) / wide) * (1 - fabsf((float)b - j) / wide);
			plane->depth[b * f->cells + a][0] += more;
			plane->depth[b * f->cells + a][1] += more * s;
		}
}

static void put_hair(const struct portrait_fringe *f, const struct plane *plane, const struct hair *h, const float (*point)[3])
{
	for (int k = 0; k + 1 < h->n; k++) {
		float way[3];
		for (int c = 0; c < 3; c++)
			way[c] = point[k + 1][c] - point[k][c];
		const float along = dot(way, plane->dir), len2 = dot(way, way), breadth = hair_half(h, k) + hair_half(h, k + 1);
		float off[3];
		for (int c = 0; c < 3; c++)
			off[c] = 0.5f * (point[k][c] + point[k + 1][c]) - f->center[c];
		const bool lies = h->kind == HAIR_BROW;
		const float wide = softness(f, plane, off, lies), across2 = fmaxf(len2 - along * along, 0);
		const int pieces = 1 + (int)(sqrtf(across2) / (step * wide * f->cell));
		for (int i = 0; i < pieces; i++) {
			for (int c = 0; c < 3; c++)
				off[c] = point[k][c] + ((float)i + 0.5f) / (float)pieces * way[c] - f->center[c];
			put(f, plane, off, (lies ? seen_lit : 1) * breadth * sqrtf(across2) / (float)pieces, wide, lies ? lifted_mm : 0);
		}
	}
}

struct portrait_fringe *portrait_fringe_new(const struct portrait *p, int side, bool brows, int n, const struct envmap_light light[])
{
	struct portrait_fringe *f = mem_new(1, sizeof *f);
	const struct rig_globe *g = &p->rig->globe[side];
	f->radius = (float)g->radius;
	f->cell = cell_mm[brows] * f->radius / 12;
	f->cells = 2 * (int)ceilf(reach[brows] * f->radius / f->cell);
	f->n = n;
	for (int c = 0; c < 3; c++)
		f->center[c] = (float)g->center[c];
	f->plane = mem_new((size_t)n + 1, sizeof *f->plane);
#pragma omp parallel for schedule(dynamic)
	for (int k = 0; k < n; k++) {
		plane_make(&f->plane[k], f->cells, k, n, light);
		for (int i = 0; i < p->hairs.n; i++) {
			const struct hair *h = &p->hairs.hair[i];
			float point[HAIR_LASH_POINTS][3];
			if ((h->kind == HAIR_BROW && !brows) || h->side != side)
				continue;
			hair_place(point, &p->hairs, h, p->rig, (const float(*)[3])p->mesh.x);
			put_hair(f, &f->plane[k], h, (const float(*)[3])point);
		}
	}
	return f;
}

void portrait_fringe_free(struct portrait_fringe *f)
{
	for (int k = 0; f && k < f->n; k++)
		free(f->plane[k].depth);
	if (f)
		free(f->plane);
	free(f);
}

float portrait_fringe_through(const struct portrait_fringe *f, int k, const float at[3])
{
	const struct plane *plane = &f->plane[k];
	float off[3];
	for (int c = 0; c < 3; c++)
		off[c] = at[c] - f->center[c];
	const float half = 0.5f * (float)f->cells, i = dot(off, plane->across) / f->cell + half, j = dot(off, plane->up) / f->cell + half;
	if (!(i >= 0 && j >= 0 && i < (float)(f->cells - 1) && j < (float)(f->cells - 1)))
		return 1;
	const int a = (int)i, b = (int)j;
	const float x = i - (float)a, y = j - (float)b, w[4] = { (1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y };
	float depth = 0, where = 0;
	for (int q = 0; q < 4; q++) {
		const float *cell = plane->depth[(b + q / 2) * f->cells + a + q % 2];
		depth += w[q] * cell[0];
		where += w[q] * cell[1];
	}
	if (!(depth > 0))
		return 1;
	return expf(-depth * fminf(fmaxf((where / depth - dot(off, plane->dir)) / apart_mm, 0), 1));
}

static float over(const struct portrait_fringe *f, const float at[3], const float normal[3])
{
	float sum = 0, all = 0, off[3];
	for (int c = 0; c < 3; c++)
		off[c] = at[c] - f->center[c];
	if (4 * dot(off, off) > 2 * (float)f->cells * f->cell * (float)f->cells * f->cell)  // beyond all corners
		return 1;
	for (int k = 0; k < f->n; k++) {
		const float w = f->plane[k].weight * dot(f->plane[k].dir, normal);
		if (!(w > 0))
			continue;
		all += w;
		sum += w * portrait_fringe_through(f, k, at);
	}
	return all > 0 ? sum / all : 1;
}

float portrait_under_hair(const struct portrait *p, const float at[3], const float normal[3])
{
	float away2[2] = { 0 };
	for (int side = 0; side < 2; side++)
		for (int c = 0; c < 3; c++) {
			const float off = at[c] - (float)p->rig->globe[side].center[c];
			away2[side] += off * off;
		}
	const struct portrait_fringe *f = p->fringe[away2[1] < away2[0]];
	return f ? over(f, at, normal) : 1;
}
