/* deform_impl: the layout of a rig for evaluation (deform.h): blocks of vertices that need the same computations, as structures of
 * arrays. */
#ifndef RIG_DEFORM_IMPL_H
#define RIG_DEFORM_IMPL_H
#include "rig/rig.h"

enum { DEFORM_BLOCK = 128 };

/* A block of moving vertices; one that is not full repeats its last. Members are in the order in which they are read; the last are read
 * for some blocks only. mm, px of the modelling camera. */
struct deform_terms_block {
	float mean[2][DEFORM_BLOCK], skin[2][RIG_SKIN_COMPONENTS][DEFORM_BLOCK];  // u = mean + basis e; basis: the skin's components
	float offset[3][DEFORM_BLOCK], lean[3][DEFORM_BLOCK];  // rest less the skull map there: position, normal
	float clear[DEFORM_BLOCK];                             // squared distance from the centre that no globe reaches, mm^2
	float lids[2][RIG_LID_COMPONENTS][DEFORM_BLOCK];       // basis: the lids' components
	float thickness[DEFORM_BLOCK], gap[DEFORM_BLOCK], glue[DEFORM_BLOCK];
	float normal0[3][DEFORM_BLOCK], tau0[3][DEFORM_BLOCK]; // at rest: normal; unit direction from the globe's centre
};

/* A block of globe vertices: position from the globe's centre and normal, at rest. */
struct deform_globe_block {
	float x[3][DEFORM_BLOCK], normal[3][DEFORM_BLOCK];
};

/* Consecutive rows of the mesh. */
struct deform_run {
	int vertex, n;
};

struct deform_block {
	int n, side;             // vertices; the globe: 0 left, 1 right
	bool lids, glue;         // they move with the lids' components; they keep their distance from the globe
	int run, n_runs;         // the runs of rows that its vertices are written to
};

struct deform {
	const struct rig *rig;
	int n, n_blocks, n_globe, n_globe_blocks;
	struct deform_block *block, *globe_block;
	struct deform_terms_block *terms;
	struct deform_globe_block *globe;
	struct deform_run *run;
};

#endif
