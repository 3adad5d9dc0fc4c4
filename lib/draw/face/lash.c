/* Lashes: hairs rooted on the lids' margins. The margins are found in pictures at rest: above and below what shows of an eye. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "draw/face/impl.h"

enum { VIEW = 480, UPPER = 95, LOWER = 60, POINTS = 6, QUADS = POINTS - 1, TRIANGLES = 4 * QUADS };

/* One hair: three vertices and their weights, how long, which way it leans along the lid. */
struct portrait_lash {
	int vertex[3], side;
	float weight[3], length, fan, lift;
	float cover[POINTS];  // of a hair as thick as it is, by one as thick as it is drawn
	bool upper;
};

struct rim {
	int face[VIEW], n;
	float px[VIEW][2];
};

/* Faces along the upper or lower edge of what shows of the eye, column by column. */
static void find_rim(struct rim *rim, const struct portrait_spot *spots, int side, bool upper)
{
	rim->n = 0;
	for (int x = 0; x < VIEW; x++)
		for (int k = 0; k < VIEW; k++) {
			int y = upper ? k : VIEW - 1 - k, edge = upper ? y - 1 : y + 1;
			if (spots[(long)y * VIEW + x].face != -2 - side)
				continue;
			if (edge >= 0 && edge < VIEW && spots[(long)edge * VIEW + x].face >= 0) {
				rim->face[rim->n] = spots[(long)edge * VIEW + x].face;
				rim->px[rim->n][0] = (float)x + 0.5f;
				rim->px[rim->n++][1] = (float)edge + 0.5f;
			}
			break;
		}
}

static void plant(struct portrait *p, const struct rim *rim, const struct portrait_rays *rays, int side, bool upper, struct rng *rng)
{
	int hairs = upper ? UPPER : LOWER, reach = 6;
	for (int i = 0; i < hairs && rim->n > 20; i++) {
		// None in the inner eighth: there the lids hold the tear ducts.
		double outward = 0.12 + 0.86 * (i + rng_range(rng, 0.1, 0.9)) / hairs;  // 0 inner canthus, 1 outer
		int at = (int)((side ? 1 - outward : outward) * (rim->n - 1));  // the person's left eye looks outward to the right
		// A margin is a smooth curve: a column off it has found something else.
		int left = at > reach ? at - reach : 0, right = at + reach < rim->n ? at + reach : rim->n - 1;
		if (fabsf(rim->px[at][1] - 0.5f * (rim->px[left][1] + rim->px[right][1])) > 3)
			continue;
		struct portrait_lash *l = &p->lash[p->n_lashes++];
		float dir[3];
		portrait_ray(dir, rays, rim->px[at][0], rim->px[at][1]);
		memcpy(l->vertex, p->mesh.faces[rim->face[at]], sizeof l->vertex);
		portrait_mesh_weights(l->weight, &p->mesh, rim->face[at], rays->origin, dir);
		double size = p->rig->globe[side].radius / 12 * p->conf.lash_mm / 9;
		l->side = side;
		l->upper = upper;
		l->length = (float)(size * (upper ? 4.5 + 3.2 * sin(M_PI * fmin(outward * 0.75 + 0.15, 1)) : 3.2) * rng_range(rng, 0.75, 1.1));
		l->fan = (float)(1.5 * (outward - 0.42) + rng_range(rng, -0.22, 0.22));
		l->lift = (float)rng_range(rng, 0.8, 1.2);
	}
}

void portrait_lashes_make(struct portrait *p)
{
	struct portrait_mesh *m = &p->mesh;
	struct rng rng = { 77 };
	p->first_lash = m->n_faces;
	p->lash_vertex = m->n;
	if (!(p->conf.lash_mm > 0))
		return;
	p->lash = mem_new(2 * (UPPER + LOWER), sizeof *p->lash);
	for (int side = 0; side < 2; side++) {
		struct portrait_view view = portrait_front(p->rig, side, 3.2 * p->rig->globe[side].radius, 0, 0, VIEW, VIEW);
		struct portrait_rays rays = portrait_rays_of(&view);
		struct portrait_spot *spots = portrait_raster(p, &view, 1);
		struct rim rim;
		for (int upper = 1; upper >= 0; upper--) {
			find_rim(&rim, spots, side, upper);
			plant(p, &rim, &rays, side, upper, &rng);
		}
		free(spots);
	}
	int hairs = p->n_lashes;
	m->x = mem_grow(m->x, (size_t)(m->n + 2 * POINTS * hairs) + 1, sizeof *m->x);
	m->faces = mem_grow(m->faces, (size_t)(m->n_faces + TRIANGLES * hairs) + 1, sizeof *m->faces);
	for (int i = 0; i < hairs; i++)
		for (int k = 0; k < QUADS; k++) {
			int32_t a = p->lash_vertex + 2 * (POINTS * i + k), b = a + 1, c = a + 2, d = a + 3;
			// Both ways round: a hair has no inside.
			int32_t both[4][3] = { { a, b, c }, { b, d, c }, { a, c, b }, { b, c, d } };
			memcpy(m->faces[m->n_faces], both, sizeof both);
			m->n_faces += 4;
		}
}

static void unit(float v[3])
{
	float len = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 1e-12f;
	for (int c = 0; c < 3; c++)
		v[c] /= len;
}

static void cross(float out[3], const float a[3], const float b[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The frame a hair grows in: off the globe, along the lid outward, up over the lid. */
static void frame_of(float root[3], float off[3], float along[3], float up[3], const struct portrait *p, const struct portrait_lash *l)
{
	const double *o = p->rig->globe[l->side].center;
	float across[3];
	for (int c = 0; c < 3; c++) {
		root[c] = 0;
		for (int k = 0; k < 3; k++)
			root[c] += l->weight[k] * p->mesh.x[l->vertex[k]][c];
		off[c] = root[c] - (float)o[c];
		across[c] = (float)p->rig->head_from_target[0][c] * (l->side ? -1.0f : 1.0f);
	}
	unit(off);
	cross(up, off, across);
	if (l->side)
		for (int c = 0; c < 3; c++)
			up[c] = -up[c];
	unit(up);
	cross(along, up, off);
	if (l->side)
		for (int c = 0; c < 3; c++)
			along[c] = -along[c];
}

void portrait_lashes_move(struct portrait *p, const struct portrait_view *view)
{
	struct portrait_rays rays = portrait_rays_of(view);
	for (int i = 0; i < p->n_lashes; i++) {
		struct portrait_lash *l = &p->lash[i];
		float root[3], off[3], along[3], up[3], point[POINTS][3];
		frame_of(root, off, along, up, p, l);
		for (int k = 0; k < POINTS; k++) {
			float s = (float)k / QUADS, out = 0.95f * s - 0.25f * s * s, side = l->fan * (0.45f * s + 0.2f * s * s);
			float rise = l->upper ? l->lift * (-0.42f * s + 0.60f * s * s) : -l->lift * (0.15f * s + 0.28f * s * s);
			for (int c = 0; c < 3; c++)
				point[k][c] = root[c] + 0.12f * off[c] + l->length * (out * off[c] + side * along[c] + rise * up[c]);
		}
		// Never thinner than the distance of samples; the excess cover is compensated in its colour.
		float apart = 0, half0 = 0.062f * (float)(p->rig->globe[l->side].radius / 12);
		for (int c = 0; c < 3; c++)
			apart += (rays.origin[c] - root[c]) * (rays.origin[c] - root[c]);
		apart = sqrtf(apart) / (float)(view->focal_px * p->conf.samples);
		for (int k = 0; k < POINTS; k++) {
			float way[3], to[3], wide[3], own = half0 * (1 - 0.85f * (float)k / QUADS), half = fmaxf(own, 0.45f * apart);
			l->cover[k] = own / half;
			for (int c = 0; c < 3; c++) {
				way[c] = point[k < QUADS ? k + 1 : k][c] - point[k < QUADS ? k : k - 1][c];
				to[c] = rays.origin[c] - point[k][c];
			}
			cross(wide, way, to);
			unit(wide);
			float *a = p->mesh.x[p->lash_vertex + 2 * (POINTS * i + k)], *b = a + 3;
			for (int c = 0; c < 3; c++) {
				a[c] = point[k][c] - half * wide[c];
				b[c] = point[k][c] + half * wide[c];
			}
		}
	}
}

void portrait_lash_pin(struct portrait_pin *pin, const struct portrait *p, int vertex)
{
	const struct portrait_lash *l = &p->lash[(vertex - p->lash_vertex) / (2 * POINTS)];
	const float *x = p->mesh.x[vertex];
	float root[3], off[3], along[3], up[3];
	frame_of(root, off, along, up, p, l);
	*pin = (struct portrait_pin){ .side = l->side };
	memcpy(pin->vertex, l->vertex, sizeof pin->vertex);
	memcpy(pin->weight, l->weight, sizeof pin->weight);
	for (int c = 0; c < 3; c++) {
		pin->local[0] += off[c] * (x[c] - root[c]);
		pin->local[1] += along[c] * (x[c] - root[c]);
		pin->local[2] += up[c] * (x[c] - root[c]);
	}
}

void portrait_lash_colour(float rgb[3], const struct portrait *p, int face)
{
	static const float hair[3] = { 0.022f, 0.014f, 0.010f };
	const struct portrait_lash *l = &p->lash[(face - p->first_lash) / TRIANGLES];
	int quad = (face - p->first_lash) % TRIANGLES / 4;
	float tip = (float)quad / QUADS, cover = 0.5f * (l->cover[quad] + l->cover[quad + 1]);
	const float *light = p->mesh.light[l->vertex[0]];
	for (int c = 0; c < 3; c++)
		rgb[c] = cover * hair[c] * (1 + tip) * (0.4f + light[c]) + (1 - cover) * p->mesh.albedo[l->vertex[0]][c] * light[c];
}
