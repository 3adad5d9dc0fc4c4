#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/make/make_impl.h"

static double finite_or(double x, double otherwise)
{
	return isfinite(x) ? x : otherwise;
}

/* Controls of the reference frame; 0 where an eye was not learnt. free(). */
static double *rest_controls(const struct skin_model *model)
{
	double *c = mem_new((size_t)model->n_inputs, sizeof *c);
	for (int i = 0; i < model->n_inputs; i++)
		c[i] = finite_or(model->rest_controls[i], 0);
	return c;
}

static void take_skin(struct rig_motion *m, const struct skin_model *model)
{
	int kept = model->n_skin_pc < RIG_SKIN_COMPONENTS ? model->n_skin_pc : RIG_SKIN_COMPONENTS;
	for (int i = 0; i < model->n_vertices; i++) {
		if (!isfinite(model->vertex_rms[i]))
			continue;  // not modelled: its motion is extrapolated from its neighbours
		m->vertex[m->n] = model->vertices[i];
		for (int j = 0; j < 2; j++) {
			m->rest_px[m->n][j] = model->u0[2 * i + j];
			for (int k = 0; k < model->n_skin_pc; k++)
				m->rest_px[m->n][j] += model->J[(2 * i + j) * model->n_skin_pc + k] * model->rest_e[k];
		}
		for (int j = 0; j < 2; j++)
			for (int k = 0; k < kept; k++)
				m->basis[m->n][j * RIG_COMPONENTS + k] = model->J[(2 * i + j) * model->n_skin_pc + k];
		m->n++;
	}
}

void rig_motion_of_model(struct rig_motion *m, const struct skin_model *model)
{
	int kept = model->n_skin_pc < RIG_SKIN_COMPONENTS ? model->n_skin_pc : RIG_SKIN_COMPONENTS;
	*m = (struct rig_motion){ .n_inputs = model->n_inputs, .n_points = model->n_points, .camera = model->camera, .known = model->known, .own_low = own_low_of(model) };
	size_t row = (size_t)model->n_inputs + 1;
	double *W = mem_new((size_t)model->n_skin_pc * row + 1, sizeof *W);
	skin_model_fold(W, model);
	m->W = mem_new(RIG_COMPONENTS * row, sizeof *m->W);
	memcpy(m->W, W, (size_t)kept * row * sizeof *W);
	free(W);
	m->vertex = mem_new((size_t)model->n_vertices + 1, sizeof *m->vertex);
	m->basis = mem_new((size_t)model->n_vertices + 1, sizeof *m->basis);
	m->rest_px = mem_new((size_t)model->n_vertices + 1, sizeof *m->rest_px);
	m->lid = mem_new((size_t)model->n_lid / 2 + 1, sizeof *m->lid);
	m->lid_basis = mem_new((size_t)model->n_lid / 2 + 1, sizeof *m->lid_basis);
	double *c = rest_controls(model);
	rig_motion_components(m->rest_e, m, c);
	for (int k = 0; k < 4; k++) {
		m->rest_aperture[k] = finite_or(model->rest_controls[k < 2 ? 3 + k : 6 + k], 0);
		for (int j = 0; j < 3; j++)
			m->baseline[k][j] = finite_or(model->baseline[k / 2][k % 2][j], 0);
	}
	m->expression = mem_new((size_t)model->n_au + 1, sizeof *m->expression);
	if (model->n_au)
		memcpy(m->expression, model->expression, (size_t)model->n_au * sizeof *m->expression);
	skin_model_range(m->aperture_px, model);
	take_skin(m, model);
	rig_motion_take_lids(m, model, c);
	free(c);
}

void rig_motion_free(struct rig_motion *m)
{
	free(m->W);
	free(m->expression);
	free(m->vertex);
	free(m->basis);
	free(m->rest_px);
	free(m->lid);
	free(m->lid_basis);
	*m = (struct rig_motion){ 0 };
}
