#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "skin/rig_make.h"

enum { FIT = RIG_COMPONENTS + 1, GAZES = 5, CLOSINGS = 6 };

static double finite_or(double x, double otherwise)
{
	return isfinite(x) ? x : otherwise;
}

/* The reference frame's; 0 where an eye was not learnt. free(). */
static double *rest_controls(const struct skin_model *model)
{
	double *c = mem_new((size_t)model->n_inputs, sizeof *c);
	for (int i = 0; i < model->n_inputs; i++)
		c[i] = finite_or(model->rest_controls[i], 0);
	return c;
}

static void open_at(double *c, const struct skin_model *model, double h, double v, double closing)
{
	for (int eye = 0; eye < 2; eye++) {
		double control[2] = { 0 };
		c[5 * eye] = h;
		c[5 * eye + 1] = v;
		skin_model_baseline(control, model, eye, closing, h, v);
		for (int k = 0; k < 2; k++)
			c[5 * eye + 3 + k] = finite_or(control[k], 0);
	}
}

static void components(double e[RIG_COMPONENTS], const struct rig_motion *m, const double *c)
{
	for (int k = 0; k < RIG_COMPONENTS; k++) {
		const double *row = m->W + k * (m->n_inputs + 1);
		e[k] = row[m->n_inputs];
		for (int i = 0; i < m->n_inputs; i++)
			e[k] += row[i] * c[i];
	}
}

/* Normal equations of l = l_rest + basis (e - e_rest): no constant, so that the lids at rest are where they are. */
struct regression {
	double ee[RIG_COMPONENTS][RIG_COMPONENTS];
	double *le;        // [n_lid][RIG_COMPONENTS]
	double *rest, *l;  // [n_lid]
	double total;
	int n;
};

static void add_sample(struct regression *r, const struct rig_motion *m, const struct skin_model *model, const double *c, double *g)
{
	double e[RIG_COMPONENTS];
	components(e, m, c);
	skin_model_inputs(g, model, c);
	skin_model_lids(r->l, model, g);
	for (int k = 0; k < RIG_COMPONENTS; k++)
		e[k] -= m->rest_e[k];
	for (int j = 0; j < RIG_COMPONENTS; j++)
		for (int k = 0; k < RIG_COMPONENTS; k++)
			r->ee[j][k] += e[j] * e[k];
	for (int i = 0; i < model->n_lid; i++) {
		double d = r->l[i] - r->rest[i];
		for (int k = 0; k < RIG_COMPONENTS && isfinite(d); k++)
			r->le[i * RIG_COMPONENTS + k] += d * e[k];
		r->total += isfinite(d) ? d * d : 0;
	}
	r->n++;
}

static void gather(struct regression *r, const struct rig_motion *m, const struct skin_model *model)
{
	double *c = mem_new((size_t)m->n_inputs, sizeof *c), *g = mem_new((size_t)m->n_inputs, sizeof *g);
	for (int i = 0; i < GAZES * GAZES * CLOSINGS; i++) {
		double at[2];
		for (int k = 0; k < 2; k++) {
			double low = finite_or(model->low[k], finite_or(model->low[k + 5], -15));
			double high = finite_or(model->high[k], finite_or(model->high[k + 5], 15));
			at[k] = low + (high - low) * ((k ? i / GAZES : i) % GAZES) / (GAZES - 1);
		}
		open_at(c, model, at[0], at[1], (double)(i / (GAZES * GAZES)) / (CLOSINGS - 1));
		add_sample(r, m, model, c, g);
	}
	for (int a = 0; a < model->n_au; a++) {
		open_at(c, model, 0, 0, 1);
		c[SKIN_EYE_INPUTS + a] = 1;
		for (int k = 0; k < GAZES; k++)
			add_sample(r, m, model, c, g);
		c[SKIN_EYE_INPUTS + a] = 0;
	}
	free(c);
	free(g);
}

/* Solves the 4 x 4 system for each lid coordinate; a trace of ridge keeps components that nothing moves at zero. */
static void solve(struct rig_motion *m, struct regression *r, int n_lid)
{
	double trace = 1e-12, explained = 0;
	double A[RIG_COMPONENTS * RIG_COMPONENTS];
	for (int k = 0; k < RIG_COMPONENTS; k++)
		trace += r->ee[k][k];
	for (int i = 0; i < n_lid; i++) {
		double x[RIG_COMPONENTS];
		for (int j = 0; j < RIG_COMPONENTS; j++) {
			for (int k = 0; k < RIG_COMPONENTS; k++)
				A[RIG_COMPONENTS * j + k] = r->ee[j][k] + (j == k ? 1e-9 * trace : 0);
			x[j] = r->le[i * RIG_COMPONENTS + j];
		}
		if (!chol_solve(RIG_COMPONENTS, RIG_COMPONENTS, A, x))
			memset(x, 0, sizeof x);
		for (int k = 0; k < RIG_COMPONENTS; k++) {
			m->lid_basis[i / 2][i % 2 * RIG_COMPONENTS + k] = x[k];
			explained += x[k] * r->le[i * RIG_COMPONENTS + k];
		}
	}
	m->lid_error = sqrt(fmax(r->total - explained, 0) / fmax((double)r->n * n_lid / 2, 1));
}

static void take_lids(struct rig_motion *m, const struct skin_model *model)
{
	struct regression r = { 0 };
	double *c = rest_controls(model);
	r.le = mem_new((size_t)model->n_lid * RIG_COMPONENTS + 1, sizeof *r.le);
	r.rest = mem_new((size_t)model->n_lid + 1, sizeof *r.rest);
	r.l = mem_new((size_t)model->n_lid + 1, sizeof *r.l);
	skin_model_inputs(c, model, c);
	skin_model_lids(r.rest, model, c);
	for (int i = 0; i < model->n_lid; i++)
		m->lid[i / 2][i % 2] = r.rest[i];
	gather(&r, m, model);
	solve(m, &r, model->n_lid);
	free(c);
	free(r.le);
	free(r.rest);
	free(r.l);
}

static void take_skin(struct rig_motion *m, const struct skin_model *model)
{
	int kept = model->n_skin_pc < RIG_COMPONENTS ? model->n_skin_pc : RIG_COMPONENTS;
	for (int i = 0; i < model->n_vertices; i++) {
		if (!isfinite(model->vertex_rms[i]))
			continue;  // never seen: it learns from its neighbours
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
	int kept = model->n_skin_pc < RIG_COMPONENTS ? model->n_skin_pc : RIG_COMPONENTS;
	*m = (struct rig_motion){ .n_inputs = model->n_inputs, .n_points = model->n_points, .camera = model->camera };
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
	components(m->rest_e, m, c);
	free(c);
	for (int k = 0; k < 4; k++) {
		m->rest_aperture[k] = finite_or(model->rest_controls[k < 2 ? 3 + k : 6 + k], 0);
		for (int j = 0; j < 3; j++)
			m->baseline[k][j] = finite_or(model->baseline[k / 2][k % 2][j], 0);
	}
	take_skin(m, model);
	take_lids(m, model);
}

void rig_motion_free(struct rig_motion *m)
{
	free(m->W);
	free(m->vertex);
	free(m->basis);
	free(m->rest_px);
	free(m->lid);
	free(m->lid_basis);
	*m = (struct rig_motion){ 0 };
}
