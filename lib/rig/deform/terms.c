#include "rig/deform/terms.h"

#include "math/vec.h"

bool deform_terms_moves(const struct rig *rig, int vertex)
{
	const float *b = rig->basis[vertex];
	for (int k = 0; k < RIG_BASIS; k++)
		if (b[k] != 0)
			return true;
	return rig->glue[vertex] > 0;
}

void deform_terms_of(struct deform_terms *t, const struct rig *rig, int i)
{
	const struct rig_globe *globe = &rig->globe[rig->side[i]];
	float at[3], facing[3];
	double from[3];
	skull_map_at(at, facing, &rig->skull, rig->home[i]);
	for (int c = 0; c < 3; c++)
		from[c] = rig->rest[i][c] - globe->center[c];
	vec_unit(from, from);
	for (int c = 0; c < 3; c++) {
		t->offset[c] = rig->rest[i][c] - at[c];
		t->lean[c] = rig->normal[i][c] - facing[c];
		t->tau0[c] = (float)from[c];
	}
	for (int c = 0; c < 2; c++) {
		double mean = rig->home[i][c];
		for (int j = 0; j < RIG_COMPONENTS; j++) {
			t->basis[c * RIG_COMPONENTS + j] = rig->basis[i][c * RIG_COMPONENTS + j];
			mean -= (double)rig->basis[i][c * RIG_COMPONENTS + j] * rig->rest_e[j];
		}
		t->mean[c] = (float)mean;
	}
}
