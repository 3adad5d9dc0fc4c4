#include "rig/glb/poser.h"

#include <stdlib.h>

#include "base/mem.h"
#include "rig/glb/strands.h"

struct poser poser_new(const struct rig *rig, const struct hairs *hairs)
{
	const int n = strands_count(hairs);
	struct poser p = { rig, deform_new(rig), mem_new((size_t)rig->n + 1, sizeof *p.x), mem_new((size_t)rig->n + 1, sizeof *p.n), deform_near_of(rig),
		               hairs, n, mem_new((size_t)n + 1, sizeof *p.hair), mem_new((size_t)n + 1, sizeof *p.hair_rest) };
	deform_rest(p.deform, p.x, p.n);
	if (n)
		strands_place(p.hair_rest, 0, hairs, rig, (const float(*)[3])rig->rest);
	return p;
}

void poser_free(struct poser *p)
{
	deform_free(p->deform);
	free(p->x);
	free(p->n);
	free(p->hair);
	free(p->hair_rest);
	deform_near_free(&p->near);
}

void poser_pose(struct poser *p, const double *controls, double turn[2][3][3])
{
	double e[RIG_COMPONENTS];
	rig_components(e, p->rig, controls);
	rig_globes_turned(turn, p->rig, controls);
	deform_pose(p->deform, e, (const double(*)[3][3])turn, p->x, p->n);
	deform_clear(p->x, p->rig, &p->near, (const double(*)[3][3])turn);
}

void poser_still(struct poser *p)
{
	double turn[2][3][3];
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(turn[s], p->rig, (double[]){ 0, 0, 0 });
	deform_pose(p->deform, p->rig->rest_e, (const double(*)[3][3])turn, p->x, p->n);
	deform_clear(p->x, p->rig, &p->near, (const double(*)[3][3])turn);
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
	if (p->n_hair)
		strands_place(p->hair, 0, p->hairs, p->rig, (const float(*)[3])p->x);
	for (int i = 0; i < 3 * p->n_hair; i++)
		out[i] = p->hair[i / 3][i % 3] - p->hair_rest[i / 3][i % 3];
}
