#include "rig/make/make_impl.h"

void rig_motion_components(double e[RIG_COMPONENTS], const struct rig_motion *m, const double *c)
{
	for (int k = 0; k < RIG_COMPONENTS; k++) {
		const double *row = m->W + k * (m->n_inputs + 1);
		e[k] = row[m->n_inputs];
		for (int i = 0; i < m->n_inputs; i++)
			e[k] += row[i] * c[i];
	}
}
