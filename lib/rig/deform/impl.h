/* deform_impl: what a rig is while it is evaluated (deform.h): blocks of vertices that take the same way, each number of theirs an
 * array of its own. */
#ifndef RIG_DEFORM_IMPL_H
#define RIG_DEFORM_IMPL_H
#include "rig/rig.h"

enum { DEFORM_BLOCK = 128 };

/* Of the moving vertices; a block that is not full repeats its last. In the order in which they are read: what comes last is
 * read of some blocks alone. */
struct deform_terms_block {
	float mean[2][DEFORM_BLOCK], skin[2][RIG_SKIN_COMPONENTS][DEFORM_BLOCK];  // u = mean + basis e: the skin's components,
	float offset[3][DEFORM_BLOCK], lean[3][DEFORM_BLOCK];  // rest less the skull map there: position, normal
	float clear[DEFORM_BLOCK];                             // mm^2: no globe reaches what is farther from its centre
	float lids[2][RIG_LID_COMPONENTS][DEFORM_BLOCK];       // then those of the lids
	float thickness[DEFORM_BLOCK], gap[DEFORM_BLOCK], glue[DEFORM_BLOCK];
	float normal0[3][DEFORM_BLOCK], tau0[3][DEFORM_BLOCK]; // at rest: normal; unit direction from the globe's centre
};

/* Of the globes, which turn: from the centre at rest. */
struct deform_globe_block {
	float x[3][DEFORM_BLOCK], normal[3][DEFORM_BLOCK];
};

/* Rows of the mesh that lie one behind the other. */
struct deform_run {
	int vertex, n;
};

struct deform_block {
	int n, side;             // vertices; of which globe: 0 left, 1 right
	bool lids, glue;         // some move with the lids' components; some keep their distance from the globe
	int run, n_runs;         // where the vertices go
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
