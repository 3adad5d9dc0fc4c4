#include "rig/glb/poser.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/deform/lifted.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"

/* Hairs and tears in the pose x. */
static void place(float (*out)[3], const struct poser *p, const float (*x)[3])
{
	if (p->n_strands)
		strands_place(out, 0, p->conf->hairs, p->rig, x);
	if (p->n_hair > p->n_strands)
		tears_place(out + p->n_strands, 0, p->conf->hairs, p->rig, x, (const double(*)[3][3])p->turn, p->conf->tear_mm, p->conf->over_mm);
}

static void find_faces(struct poser *p)
{
	p->face = mem_new((size_t)p->rig->n_faces + 1, sizeof *p->face);
	for (int f = 0; f < p->rig->n_faces; f++) {
		const int32_t *v = p->rig->faces[f];
		if (p->near.moves[v[0]] || p->near.moves[v[1]] || p->near.moves[v[2]])
			p->face[p->n_faces++] = f;
	}
}

/* Of the vertices that move: weighted by area, as mesh_normals has them at rest. */
static void take_normals(struct poser *p)
{
	for (int i = 0; i < p->rig->n; i++)
		if (p->near.moves[i])
			memset(p->n[i], 0, sizeof p->n[i]);
	for (int f = 0; f < p->n_faces; f++) {
		const int32_t *v = p->rig->faces[p->face[f]];
		float a[3], b[3], n[3];
		for (int c = 0; c < 3; c++) {
			a[c] = p->x[v[1]][c] - p->x[v[0]][c];
			b[c] = p->x[v[2]][c] - p->x[v[0]][c];
		}
		vecf_cross(n, a, b);
		for (int k = 0; k < 9; k++)
			p->n[v[k / 3]][k % 3] += p->near.moves[v[k / 3]] ? n[k % 3] : 0;
	}
	for (int i = 0; i < p->rig->n; i++)
		if (p->near.moves[i])
			vecf_unit(p->n[i]);
}

struct poser poser_new(const struct rig *rig, const struct glb_conf *conf)
{
	const int strands = strands_count(conf->hairs), n = strands + (conf->tear_mm > 0 ? tears_count(conf->hairs) : 0);
	struct poser p = { .rig = rig, .deform = deform_new(rig), .near = deform_near_of(rig), .conf = conf, .n_strands = strands, .n_hair = n };
	p.x = mem_new((size_t)rig->n + 1, sizeof *p.x);
	p.n = mem_new((size_t)rig->n + 1, sizeof *p.n);
	p.hair = mem_new((size_t)n + 1, sizeof *p.hair);
	p.hair_rest = mem_new((size_t)n + 1, sizeof *p.hair_rest);
	find_faces(&p);
	deform_rest(p.deform, p.x, 0);
	memcpy(p.n, rig->normal, (size_t)rig->n * sizeof *p.n);
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(p.turn[s], rig, (double[]){ 0, 0, 0 });
	place(p.hair_rest, &p, (const float(*)[3])rig->rest);
	return p;
}

void poser_free(struct poser *p)
{
	deform_free(p->deform);
	free(p->x);
	free(p->n);
	free(p->face);
	free(p->hair);
	free(p->hair_rest);
	deform_near_free(&p->near);
}

/* The pose of components e, the globes turned as p->turn says; lifted: of deform_settle. */
static void pose(struct poser *p, const double e[RIG_COMPONENTS], const double *lifted)
{
	deform_pose(p->deform, e, (const double(*)[3][3])p->turn, p->x, 0);
	deform_settle(p->x, p->rig, &p->near, (const double(*)[3][3])p->turn, lifted);
	take_normals(p);
}

void poser_pose(struct poser *p, const double *controls, double turn[2][3][3])
{
	double e[RIG_COMPONENTS], lifted[2];
	deform_lifted(lifted, &p->near, p->rig, controls);
	rig_components(e, p->rig, controls);
	rig_globes_turned(turn, p->rig, controls);
	memcpy(p->turn, turn, sizeof p->turn);
	pose(p, e, lifted);
}

void poser_from_still(struct poser *p, const double *controls, double share)
{
	double e[RIG_COMPONENTS];
	rig_components(e, p->rig, controls);
	for (int k = 0; k < RIG_COMPONENTS; k++)
		e[k] = p->rig->rest_e[k] + share * (e[k] - p->rig->rest_e[k]);
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(p->turn[s], p->rig, (double[]){ 0, 0, 0 });
	pose(p, e, 0);
}

void poser_still(struct poser *p)
{
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(p->turn[s], p->rig, (double[]){ 0, 0, 0 });
	pose(p, p->rig->rest_e, 0);
}

void poser_skin(float *x, float *lean, const struct poser *p, int n, const int *vertex)
{
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 3; c++) {
			x[3 * i + c] = p->x[vertex[i]][c] - p->rig->rest[vertex[i]][c];
			lean[3 * i + c] = p->n[vertex[i]][c] - p->rig->normal[vertex[i]][c];
		}
}

void poser_hair(float *out, const struct poser *p)
{
	place(p->hair, p, (const float(*)[3])p->x);
	for (int i = 0; i < 3 * p->n_hair; i++)
		out[i] = p->hair[i / 3][i % 3] - p->hair_rest[i / 3][i % 3];
}

float poser_own_side(const struct poser *p, int eye, const float x[3])
{
	static const double blend_mm = 10;  // to either side of the nose's bridge
	const struct rig *rig = p->rig;
	double from_middle = 0;
	for (int c = 0; c < 3; c++)
		from_middle += rig->head_from_target[0][c] * (x[c] - 0.5 * (rig->globe[0].center[c] + rig->globe[1].center[c]));
	const double t = fmin(fmax(0.5 + (eye ? -0.5 : 0.5) * from_middle / blend_mm, 0), 1);
	return (float)(t * t * (3 - 2 * t));
}
