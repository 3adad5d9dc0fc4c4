#include "rig/deform/deform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/deform/impl.h"
#include "rig/deform/terms.h"

enum { BLOCK = DEFORM_BLOCK };

/* Kinds of vertices by the computations they need: sums of RIGHT, LIDS and GLUE; globes; still. Blocks hold one kind, in the mesh's
 * order. */
enum { RIGHT = 1, LIDS = 2, GLUE = 4, KINDS = 8, GLOBE = KINDS, STILL = GLOBE + 2 };

static int kind_of(const struct rig *rig, int i)
{
	bool lids = false;
	if (rig_is_globe(rig->part[i]))
		return GLOBE + (rig->part[i] == RIG_GLOBE_RIGHT);
	if (!deform_terms_moves(rig, i))
		return STILL;
	for (int c = 0; c < 2; c++)
		for (int k = RIG_SKIN_COMPONENTS; k < RIG_COMPONENTS; k++)
			lids = lids || rig->basis[i][c * RIG_COMPONENTS + k] != 0;
	return (rig->side[i] ? RIGHT : 0) + (lids ? LIDS : 0) + (rig->glue[i] > 0 ? GLUE : 0);
}

static void take_vertex(struct deform_terms_block *to, int k, const struct rig *rig, int i, const float most[2])
{
	struct deform_terms t;
	deform_terms_of(&t, rig, i);
	for (int c = 0; c < 3; c++) {
		to->offset[c][k] = t.offset[c];
		to->lean[c][k] = t.lean[c];
		to->normal0[c][k] = rig->normal[i][c];
		to->tau0[c][k] = t.tau0[c];
	}
	for (int c = 0; c < 2; c++) {
		const float *basis = t.basis + c * RIG_COMPONENTS;
		to->mean[c][k] = t.mean[c];
		for (int j = 0; j < RIG_SKIN_COMPONENTS; j++)
			to->skin[c][j][k] = basis[j];
		for (int j = 0; j < RIG_LID_COMPONENTS; j++)
			to->lids[c][j][k] = basis[RIG_SKIN_COMPONENTS + j];
	}
	to->thickness[k] = rig->thickness[i];
	to->gap[k] = rig->gap[i];
	to->glue[k] = rig->glue[i];
	float clear = (most[rig->side[i]] + rig->thickness[i]) * 1.0001f;  // a margin above single precision's rounding
	to->clear[k] = clear * clear;
}

static void take_globe(struct deform_globe_block *to, int k, const struct rig *rig, int i)
{
	const double *center = rig->globe[rig->part[i] == RIG_GLOBE_RIGHT].center;
	for (int c = 0; c < 3; c++) {
		to->x[c][k] = (float)(rig->rest[i][c] - center[c]);
		to->normal[c][k] = rig->normal[i][c];
	}
}

/* Largest distance of a globe's surface from its centre, mm. */
static float most_of(const struct globe_map *map)
{
	float most = 0;
	for (int i = 0; i < (map->n + 1) * (map->n + 1); i++)
		most = fmaxf(most, map->radius[i]);
	return most;
}

/* Puts n vertices of one kind into blocks. run: number of runs so far, in and out. */
static void into_blocks(struct deform *d, int kind, int n, const int *vertex, int *run)
{
	const struct rig *rig = d->rig;
	const float most[2] = { most_of(&rig->globe[0].map), most_of(&rig->globe[1].map) };
	bool globe = kind >= GLOBE;
	for (int first = 0; first < n; first += BLOCK) {
		struct deform_block *b = globe ? &d->globe_block[d->n_globe_blocks] : &d->block[d->n_blocks];
		*b = (struct deform_block){ .n = n - first < BLOCK ? n - first : BLOCK, .side = kind & RIGHT, .lids = kind & LIDS,
			                        .glue = kind & GLUE, .run = *run };
		for (int k = 0; k < BLOCK; k++) {
			int i = vertex[first + (k < b->n ? k : b->n - 1)];
			if (globe)
				take_globe(&d->globe[d->n_globe_blocks], k, rig, i);
			else
				take_vertex(&d->terms[d->n_blocks], k, rig, i, most);
			if (k >= b->n)
				continue;
			if (k == 0 || i != vertex[first + k - 1] + 1)
				d->run[(*run)++] = (struct deform_run){ .vertex = i };
			d->run[*run - 1].n++;
		}
		b->n_runs = *run - b->run;
		*(globe ? &d->n_globe_blocks : &d->n_blocks) += 1;
	}
}

struct deform *deform_new(const struct rig *rig)
{
	struct deform *d = mem_new(1, sizeof *d);
	int *vertex = mem_new((size_t)rig->n + 1, sizeof *vertex), most = rig->n / BLOCK + STILL, runs = 0;
	uint8_t *kind = mem_new((size_t)rig->n + 1, 1);
	for (int i = 0; i < rig->n; i++)
		kind[i] = (uint8_t)kind_of(rig, i);
	d->rig = rig;
	d->block = mem_new((size_t)most, sizeof *d->block);
	d->globe_block = mem_new((size_t)most, sizeof *d->globe_block);
	d->terms = mem_array((size_t)most, sizeof *d->terms);
	d->globe = mem_array((size_t)most, sizeof *d->globe);
	d->run = mem_new((size_t)rig->n + 1, sizeof *d->run);
	for (int of = 0; of < STILL; of++) {
		int n = 0;
		for (int i = 0; i < rig->n; i++)
			if (kind[i] == of)
				vertex[n++] = i;
		into_blocks(d, of, n, vertex, &runs);
		*(of < GLOBE ? &d->n : &d->n_globe) += n;
	}
	free(kind);
	free(vertex);
	return d;
}

void deform_free(struct deform *d)
{
	if (!d)
		return;
	free(d->block);
	free(d->globe_block);
	free(d->terms);
	free(d->globe);
	free(d->run);
	free(d);
}

void deform_rest(const struct deform *d, float (*xyz)[3], float (*normal)[3])
{
	memcpy(xyz, d->rig->rest, (size_t)d->rig->n * sizeof *xyz);
	if (normal)
		memcpy(normal, d->rig->normal, (size_t)d->rig->n * sizeof *normal);
}
