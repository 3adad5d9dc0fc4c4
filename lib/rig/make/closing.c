#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "rig/drive.h"
#include "rig/make/make_impl.h"

// Inputs of an eye (model/model.h), and the first of them that is an aperture.
enum { EYE_INPUTS = SKIN_EYE_INPUTS / 2, APERTURES = 3 };

/* Adds a pose to the normal equations of direction . (e - rest_e) = want. */
static void add_pose(double m[RIG_COMPONENTS][RIG_COMPONENTS], double right[RIG_COMPONENTS], const struct rig *rig, const double *controls, double want)
{
	double e[RIG_COMPONENTS];
	rig_components(e, rig, controls);
	for (int i = 0; i < RIG_COMPONENTS; i++)
		e[i] -= rig->rest_e[i];
	for (int i = 0; i < RIG_COMPONENTS; i++) {
		right[i] += want * e[i];
		for (int j = 0; j < RIG_COMPONENTS; j++)
			m[i][j] += e[i] * e[j];
	}
}

/* Both eyes looking at h, v; shut: eyes whose lids are, a bit each. */
static void look(double *c, double *all, const struct rig *rig, double h, double v, int shut)
{
	drive_look(c, rig, h, v, 1);
	drive_look(all, rig, h, v, 0);
	for (int eye = 0; eye < 2; eye++)
		for (int k = APERTURES; k < EYE_INPUTS && shut >> eye & 1; k++)
			c[EYE_INPUTS * eye + k] = all[EYE_INPUTS * eye + k];
}

void rig_closing_direction(double out[RIG_COMPONENTS], const struct rig *rig, int side, const double closed[RIG_COMPONENTS])
{
	static const double gazes[] = { -20, -10, 0, 10, 20 }, ridge = 0.05;
	double m[RIG_COMPONENTS][RIG_COMPONENTS] = { 0 }, square = 0, along = 0;
	double *c = mem_new(2 * (size_t)rig->n_inputs + 1, sizeof *c);
	memset(out, 0, RIG_COMPONENTS * sizeof *out);
	for (int v = 0; v < COUNT(gazes); v++)
		for (int h = 0; h < COUNT(gazes); h += 2)
			for (int shut = 0; shut < 4; shut++) {
				look(c, c + rig->n_inputs, rig, gazes[h], gazes[v], shut);
				add_pose(m, out, rig, c, shut >> side & 1);
			}
	for (int i = SKIN_EYE_INPUTS; i < rig->n_inputs; i++) {
		drive_look(c, rig, 0, 0, 1);
		c[i] = 1;
		add_pose(m, out, rig, c, 0);
	}
	free(c);
	for (int k = 0; k < RIG_COMPONENTS; k++)
		square += closed[k] * closed[k];
	for (int k = 0; k < RIG_COMPONENTS; k++)
		m[k][k] += ridge * square;
	bool known = chol_solve(RIG_COMPONENTS, RIG_COMPONENTS, &m[0][0], out);
	for (int k = 0; k < RIG_COMPONENTS && known; k++)
		along += out[k] * closed[k];
	// Without usable solution (baselines not learnt, poses all alike): the projection onto the closed pose alone.
	bool usable = known && along > 0.2;
	for (int k = 0; k < RIG_COMPONENTS; k++)
		out[k] = usable ? out[k] / along : square > 0 ? closed[k] / square : 0;
}

void rig_closed_pose(double closed[RIG_COMPONENTS], const struct rig *rig)
{
	double *c = mem_new((size_t)rig->n_inputs + 1, sizeof *c);
	rig_components(closed, rig, c);
	for (int k = 0; k < RIG_COMPONENTS; k++)
		closed[k] -= rig->rest_e[k];
	free(c);
}
