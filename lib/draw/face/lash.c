/* Lashes and brows: the hairs of rig/hair, drawn as ribbons. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/face/impl.h"
#include "math/vec.h"

static const float sheen = 0.012f, tips = 0.5f;  // of light that a hair's surface reflects, whichever way; by which its tip is brighter: as the page has them (skin.frag)
enum { TRIANGLES = 4 };  // of a ribbon's piece between two points, both ways round: a hair has no inside

/* Faces of skin that do not show what is behind them: hair cards bear no hairs. Null: all. free(). */
static bool *bearing(const struct portrait *p)
{
	const struct dress *dress = p->conf.dress;
	bool *shown = dress ? mem_new((size_t)p->rig->n_faces + 1, sizeof *shown) : 0;
	for (int f = 0; dress && f < rig_own_faces(p->rig); f++)
		shown[f] = !dress_cuts(dress, dress_look(dress)->face_material[f]);
	return shown;
}

void portrait_lashes_make(struct portrait *p)
{
	struct portrait_mesh *m = &p->mesh;
	bool *shown = bearing(p);
	p->first_lash = m->n_faces;
	p->lash_vertex = m->n;
	hairs_grow(&p->hairs, p->rig, shown, &p->conf.hair);
	free(shown);
	const struct hairs *h = &p->hairs;
	p->hair_of = mem_new((size_t)h->n_points + 1, sizeof *p->hair_of);
	p->hair_cover = mem_new((size_t)h->n_points + 1, sizeof *p->hair_cover);
	p->hair_piece = mem_new((size_t)h->n_points + 1, sizeof *p->hair_piece);
	m->x = mem_grow(m->x, (size_t)(m->n + 2 * h->n_points) + 1, sizeof *m->x);
	m->faces = mem_grow(m->faces, (size_t)(m->n_faces + TRIANGLES * h->n_points) + 1, sizeof *m->faces);
	for (int i = 0, piece = 0; i < h->n; i++)
		for (int k = 0; k < h->hair[i].n; k++) {
			const int point = h->hair[i].first + k;
			p->hair_of[point] = i;
			if (k + 1 == h->hair[i].n)
				continue;
			const int32_t a = p->lash_vertex + 2 * point, b = a + 1, c = a + 2, d = a + 3;
			const int32_t both[TRIANGLES][3] = { { a, b, c }, { b, d, c }, { a, c, b }, { b, c, d } };
			memcpy(m->faces[m->n_faces], both, sizeof both);
			m->n_faces += TRIANGLES;
			p->hair_piece[piece++] = point;
		}
}

void portrait_lashes_free(struct portrait *p)
{
	hairs_free(&p->hairs);
	free(p->hair_of);
	free(p->hair_cover);
	free(p->hair_piece);
}

static void ribbon(struct portrait *p, const struct hair *h, const float origin[3], double focal_px)
{
	float point[HAIR_LASH_POINTS][3], apart = 0;
	hair_place(point, &p->hairs, h, p->rig, (const float(*)[3])p->mesh.x);
	for (int c = 0; c < 3; c++)
		apart += (origin[c] - point[0][c]) * (origin[c] - point[0][c]);
	// Never thinner than the distance of samples; a thinner hair lets through what is behind it.
	apart = sqrtf(apart) / (float)(focal_px * p->conf.samples);
	for (int k = 0; k < h->n; k++) {
		float way[3], to[3], wide[3], own = hair_half(h, k), half = fmaxf(own, 0.45f * apart);
		p->hair_cover[h->first + k] = own / half;
		for (int c = 0; c < 3; c++) {
			way[c] = point[k + 1 < h->n ? k + 1 : k][c] - point[k + 1 < h->n ? k : k - 1][c];
			to[c] = origin[c] - point[k][c];
		}
		vecf_cross(wide, way, to);
		vecf_unit(wide);
		float *a = p->mesh.x[p->lash_vertex + 2 * (h->first + k)], *b = a + 3;
		for (int c = 0; c < 3; c++) {
			a[c] = point[k][c] - half * wide[c];
			b[c] = point[k][c] + half * wide[c];
		}
	}
}

void portrait_lashes_move(struct portrait *p, const struct portrait_view *view)
{
	const struct portrait_rays rays = portrait_rays_of(view);
	for (int i = 0; i < p->hairs.n; i++)
		ribbon(p, &p->hairs.hair[i], rays.origin, view->focal_px);
}

void portrait_lash_pin(struct portrait_pin *pin, const struct portrait *p, int vertex)
{
	const struct hair *h = &p->hairs.hair[p->hair_of[(vertex - p->lash_vertex) / 2]];
	const struct hair_frame f = hair_frame_of(h, p->rig, (const float(*)[3])p->mesh.x);
	const float *x = p->mesh.x[vertex];
	*pin = (struct portrait_pin){ .side = h->side };
	memcpy(pin->vertex, h->vertex, sizeof pin->vertex);
	memcpy(pin->weight, h->weight, sizeof pin->weight);
	for (int c = 0; c < 3; c++) {
		pin->local[0] += f.off[c] * (x[c] - f.root[c]);
		pin->local[1] += f.along[c] * (x[c] - f.root[c]);
		pin->local[2] += f.up[c] * (x[c] - f.root[c]);
	}
}

float portrait_lash_cover(const struct portrait *p, int face)
{
	const int point = p->hair_piece[(face - p->first_lash) / TRIANGLES];
	return 0.5f * (p->hair_cover[point] + p->hair_cover[point + 1]);
}

void portrait_lash_albedo(double rgb[3], const struct portrait *p, const struct hair *h)
{
	const double *albedo = hair_albedo(&p->hairs, h, p->conf.hair_rgb);
	for (int c = 0; c < 3; c++)
		rgb[c] = albedo == p->hairs.brow_rgb ? fmax((albedo[c] - (double)sheen) / (1 + 0.5 * (double)tips), 0) : albedo[c];
}

void portrait_lash_colour(float rgb[3], const struct portrait *p, int face)
{
	const int point = p->hair_piece[(face - p->first_lash) / TRIANGLES];
	const struct hair *h = &p->hairs.hair[p->hair_of[point]];
	const float tip = (float)(point - h->first) / (float)(h->n - 1);
	const float *light = p->mesh.light[h->vertex[0]], *x = p->mesh.x[p->lash_vertex + 2 * point], *normal = p->mesh.normal[h->vertex[0]];
	// Of a brow some are before the hair, some behind it.
	const float before = (float)(p->hair_of[point] * 0x9e3779b1u >> 16 & 0xff) / 256;
	const float under = h->kind == HAIR_BROW ? powf(portrait_under_hair(p, x, normal), before) : 1;
	double albedo[3];
	portrait_lash_albedo(albedo, p, h);
	for (int c = 0; c < 3; c++)
		rgb[c] = ((float)albedo[c] * (1 + tips * tip) + sheen) * under * light[c];
}
