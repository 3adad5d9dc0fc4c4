/* What makes a character's margins arcs (rig/deform/arc.h), for the page's shader, which poses vertices alone: how far it moves each vertex of
 * the lids in the poses of a grid, between which the page interpolates, as it does light. The grid is finer than light's where lids follow a look down,
 * and on the way of a blink. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/web/face_impl.h"
#include "draw/web/packed.h"
#include "rig/deform/lifted.h"
#include "rig/drive.h"

enum { SH = 5, SV = 7, SA = 6, GRID = SH * SV * SA, SREST = (SA - 2) * SH * SV + 5 * SH + SH / 2, MOST = 127 };  // steps either way
static const double at_h[SH] = { -32, -16, 0, 16, 32 }, at_v[SV] = { -26, -20, -15, -10, -5, 0, 22 }, at_a[SA] = { 0, 0.25, 0.5, 0.75, 1, 1.4 };
static const float least_mm = 0.004f;   // a vertex that is moved by less in every pose is left

/* Marks the vertices of hair cards that the page draws as they are; those that show what is behind them it paints on the skin. */
static void drawn_cards(bool *moves, const struct portrait *p)
{
	const struct deform_cards *cards = &p->lids.cards;
	const struct portrait_mesh *m = &p->mesh;
	bool *card = mem_new((size_t)p->rig->n + 1, sizeof *card);
	for (int k = 0; k < cards->n; k++)
		card[cards->carried[k].vertex] = true;
	for (int k = 0; k < 3 * m->n_faces; k++) {
		const int v = m->faces[k / 3][k % 3];
		if (!(k / 3 < m->n_dressed && m->cuts[k / 3]) && v < p->rig->n && card[v])
			moves[v] = true;
	}
	free(card);
}

/* The lids' vertices that deform_settle can move. Returns how many. */
static int lids_of(int *lid, const struct portrait *p)
{
	const struct rig *rig = p->rig;
	const struct deform_near *near = &p->lids;
	bool *moves = mem_new((size_t)rig->n + 1, sizeof *moves);
	int n = 0;
	for (int k = 0; k < 3 * near->n; k++)
		moves[rig->faces[near->face[k / 3]][k % 3]] = true;
	drawn_cards(moves, p);
	for (int i = 0; i < rig->n; i++)
		if (near->moves[i] && (moves[i] || near->upper[i] > 0 || near->lower[i] > 0))
			lid[n++] = i;
	free(moves);
	return n;
}

/* Pose k of the grid, then of each expression: by[n_lid][3], mm. x: room for two poses of the rig. */
static void take(float (*by)[3], float (*x[2])[3], const struct web_face *f, int k)
{
	const struct rig *rig = f->rig;
	const int pose = k < GRID ? k : SREST;
	double e[RIG_COMPONENTS], turn[2][3][3], lifted[2], *c = mem_new((size_t)rig->n_inputs + 1, sizeof *c);
	drive_look(c, rig, at_h[pose % SH], at_v[pose / SH % SV], at_a[pose / SH / SV]);
	if (k >= GRID)
		drive_express(c, rig, k - GRID, 1, 1);
	rig_components(e, rig, c);
	rig_globes_turned(turn, rig, c);
	deform_pose(f->portrait->deform, e, (const double(*)[3][3])turn, x[0], 0);
	memcpy(x[1], x[0], (size_t)rig->n * sizeof *x[1]);
	deform_lifted(lifted, &f->portrait->lids, rig, c);
	deform_settle(x[1], rig, &f->portrait->lids, (const double(*)[3][3])turn, lifted);
	for (int i = 0; i < 3 * f->n_lid; i++)
		by[i / 3][i % 3] = x[1][f->lid[i / 3]][i % 3] - x[0][f->lid[i / 3]][i % 3];
	free(c);
}

/* Leaves out the vertices that hardly move; returns the furthest, mm. */
static float choose(struct web_face *f, float (**by)[3], int poses)
{
	float all = 0;
	int n = 0;
	for (int i = 0; i < f->n_lid; i++) {
		float most = 0;
		for (int k = 0; k < 3 * poses; k++)
			most = fmaxf(most, fabsf(by[k / 3][i][k % 3]));
		if (!(most > least_mm))
			continue;
		for (int k = 0; k < poses; k++)
			memmove(by[k][n], by[k][i], sizeof *by[k]);
		f->lid[n++] = f->lid[i];
		all = fmaxf(all, most);
	}
	f->n_lid = n;
	return all;
}

void web_settle_put(json_t *out, struct web_face *f)
{
	const int poses = GRID + f->n_au;
	const size_t n = (size_t)f->rig->n;
	float (**by)[3] = mem_new((size_t)poses, sizeof *by);
	f->lid = mem_array(n + 1, sizeof *f->lid);
	f->n_lid = lids_of(f->lid, f->portrait);
#pragma omp parallel
	{
		float (*x[2])[3] = { mem_array(n + 1, sizeof **x), mem_array(n + 1, sizeof **x) };
		deform_rest(f->portrait->deform, x[0], 0);
#pragma omp for schedule(dynamic)
		for (int k = 0; k < poses; k++) {
			by[k] = mem_array((size_t)f->n_lid + 1, sizeof *by[k]);
			take(by[k], x, f, k);
		}
		free(x[0]);
		free(x[1]);
	}
	const float step = fmaxf(choose(f, by, poses), 1e-6f) / MOST;
	const size_t row = 3 * (size_t)f->n_lid;
	uint8_t *bytes = mem_new((size_t)poses * row + 1, 1);
	for (int k = 0; k < poses; k++) {
		for (size_t i = 0; i < row; i++)
			bytes[(size_t)k * row + i] = (uint8_t)(128 + lrintf(by[k][i / 3][i % 3] / step));
		free(by[k]);
	}
	f->settled_as = mem_new(n + 1, sizeof *f->settled_as);
	for (int i = 0; i < f->n_lid; i++)
		f->settled_as[f->lid[i]] = i + 1;
	json_object_set_new(out, "settle", json_pack("{s:i,s:f,s:o,s:o,s:o,s:i,s:o}", "n", f->n_lid, "step", (double)step, "h", json_numbers(SH, at_h), "v", json_numbers(SV, at_v), "a",
	                                             json_numbers(SA, at_a), "rest_pose", SREST, "bytes", packed_json(bytes, (size_t)poses * row, 1, row)));
	free(bytes);
	free(by);
}

void web_settle_free(struct web_face *f)
{
	free(f->lid);
	free(f->settled_as);
}
