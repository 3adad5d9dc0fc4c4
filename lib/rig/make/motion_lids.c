/* Components of the lids. Skin moves nearly alike in a blink and in a gaze downwards, so the skin's components cannot distinguish how
 * far the lids come down in each; nor do they contain a wink that the clip does not show. The lids by the model (equation 3.2) are
 * regressed on the skin's components over many poses, and the principal components of the residual are added as the lids' own. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/linalg.h"
#include "math/scatter/scatter.h"
#include "rig/make/make_impl.h"

enum { GAZES = 5, CLOSINGS = 6, APART = 3 };

static double finite_or(double x, double otherwise)
{
	return isfinite(x) ? x : otherwise;
}

/* Sets one eye's controls: gaze h, v (degrees), and `closing` times the usual aperture there. */
static void open_at(double *c, const struct skin_model *model, int eye, double h, double v, double closing)
{
	double control[2] = { 0 };
	c[5 * eye] = h;
	c[5 * eye + 1] = v;
	skin_model_baseline(control, model, eye, closing, h, v);
	for (int k = 0; k < 2; k++)
		c[5 * eye + 3 + k] = finite_or(control[k], 0);
}

/* Poses over which the lids are regressed. */
struct poses {
	int n, n_inputs, n_lid;
	double *c, *e, *l;  // [n][n_inputs] controls; [n][RIG_SKIN_COMPONENTS], [n][n_lid] from rest; lids not learnt: 0
	double rest_e[RIG_COMPONENTS], *rest;
};

/* The lids by the model, l[n_lid] px, out, for controls. */
static void lids_of(double *l, const struct skin_model *model, const double *c)
{
	double *g = mem_new((size_t)model->n_inputs + 1, sizeof *g);
	skin_model_inputs(g, model, c);
	skin_model_lids(l, model, g);
	free(g);
}

/* Room for one more pose: its controls, all 0. */
static double *next(struct poses *p)
{
	p->c = mem_grow(p->c, (size_t)(p->n + 1) * (size_t)p->n_inputs, sizeof *p->c);
	double *c = p->c + (size_t)p->n++ * (size_t)p->n_inputs;
	memset(c, 0, (size_t)p->n_inputs * sizeof *c);
	return c;
}

/* Gathers poses: gazes in the model's range with eyes more or less closed; winks; convergence; expressions. */
static void gather(struct poses *p, const struct skin_model *model)
{
	double at[2][GAZES];
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < GAZES; i++) {
			double low = finite_or(model->low[k], finite_or(model->low[k + 5], -15));
			double high = finite_or(model->high[k], finite_or(model->high[k + 5], 15));
			at[k][i] = low + (high - low) * i / (GAZES - 1);
		}
	for (int i = 0; i < GAZES * GAZES * CLOSINGS; i++) {
		double *c = next(p);
		for (int eye = 0; eye < 2; eye++)
			open_at(c, model, eye, at[0][i % GAZES], at[1][i / GAZES % GAZES], (double)(i / (GAZES * GAZES)) / (CLOSINGS - 1));
	}
	for (int i = 0; i < APART * GAZES; i++) {
		double v = at[1][i / APART];
		double *wink = next(p);
		for (int eye = 0; eye < 2; eye++)
			open_at(wink, model, eye, 0, v, i % APART == eye ? 0 : 1);
		double *near = next(p);
		for (int eye = 0; eye < 2; eye++)
			open_at(near, model, eye, 0.25 * (eye ? -1 : 1) * (at[0][i % GAZES] - at[0][0]), v, 1);
	}
	for (int i = 0; i < model->n_au * GAZES * GAZES; i++) {
		double *c = next(p);
		for (int eye = 0; eye < 2; eye++)
			open_at(c, model, eye, at[0][i % GAZES], at[1][i / GAZES % GAZES], 1);
		c[SKIN_EYE_INPUTS + i / (GAZES * GAZES)] = 1;
		skin_model_express(c, model, (double[]){ 1, 1 });
	}
}

/* Components and lids of every pose, from rest. */
static void evaluate(struct poses *p, const struct rig_motion *m, const struct skin_model *model)
{
	p->e = mem_new((size_t)p->n * RIG_SKIN_COMPONENTS + 1, sizeof *p->e);
	p->l = mem_new((size_t)p->n * (size_t)p->n_lid + 1, sizeof *p->l);
	for (int i = 0; i < p->n; i++) {
		const double *c = p->c + (size_t)i * (size_t)p->n_inputs;
		double *l = p->l + (size_t)i * (size_t)p->n_lid, e[RIG_COMPONENTS];
		lids_of(l, model, c);
		rig_motion_components(e, m, c);
		for (int k = 0; k < RIG_SKIN_COMPONENTS; k++)
			p->e[i * RIG_SKIN_COMPONENTS + k] = e[k] - p->rest_e[k];
		for (int k = 0; k < p->n_lid; k++)
			l[k] = finite_or(l[k] - p->rest[k], 0);
	}
}

/* Regresses l = basis e by least squares, with a small ridge that keeps components without variance at zero, and without a constant, so
 * that the lids at rest stay in place. The residual replaces p->l. */
static void regress_on_skin(struct rig_motion *m, struct poses *p)
{
	enum { K = RIG_SKIN_COMPONENTS };
	double ee[K][K] = { 0 }, trace = 1e-12;
	for (int i = 0; i < p->n; i++)
		for (int j = 0; j < K; j++)
			for (int k = 0; k < K; k++)
				ee[j][k] += p->e[i * K + j] * p->e[i * K + k];
	for (int k = 0; k < K; k++)
		trace += ee[k][k];
	for (int c = 0; c < p->n_lid; c++) {
		double A[K][K], x[K] = { 0 }, *basis = m->lid_basis[c / 2] + c % 2 * RIG_COMPONENTS;
		memcpy(A, ee, sizeof A);
		for (int k = 0; k < K; k++)
			A[k][k] += 1e-9 * trace;
		for (int i = 0; i < p->n; i++)
			for (int k = 0; k < K; k++)
				x[k] += p->l[(long)i * p->n_lid + c] * p->e[i * K + k];
		if (!chol_solve(K, K, A[0], x))
			memset(x, 0, sizeof x);
		memcpy(basis, x, sizeof x);
		for (int i = 0; i < p->n; i++)
			for (int k = 0; k < K; k++)
				p->l[(long)i * p->n_lid + c] -= x[k] * p->e[i * K + k];
	}
}

/* Root mean square length of what is left in p->l, px a control point. */
static double rms(const struct poses *p)
{
	double sum = 0;
	for (long i = 0; i < (long)p->n * p->n_lid; i++)
		sum += p->l[i] * p->l[i];
	return sqrt(2 * sum / fmax((double)p->n * p->n_lid, 1));
}

/* Principal components V[n_lid][RIG_LID_COMPONENTS] of the residual, out; 0 beyond its rank. About rest, not about the mean: every row
 * is added with both signs. */
static void directions(double *V, struct poses *p)
{
	struct scatter s;
	double values[RIG_LID_COMPONENTS], *mirrored = mem_new((size_t)p->n * (size_t)p->n_lid + 1, sizeof *mirrored);
	int k = p->n_lid < RIG_LID_COMPONENTS ? p->n_lid : RIG_LID_COMPONENTS, threads = linalg_serial();
	double *found = mem_new((size_t)(p->n_lid * k) + 1, sizeof *found);
	for (long i = 0; i < (long)p->n * p->n_lid; i++)
		mirrored[i] = -p->l[i];
	scatter_new(&s, p->n_lid, 2 * p->n);
	scatter_add(&s, p->n, p->l, 0);
	scatter_add(&s, p->n, mirrored, 0);
	scatter_components(found, values, &s, 0, p->n_lid, k);
	for (int i = 0; i < p->n_lid; i++)
		for (int j = 0; j < k; j++)
			V[i * RIG_LID_COMPONENTS + j] = found[i * k + j];
	scatter_free(&s);
	linalg_threads(threads);
	free(found);
	free(mirrored);
}

/* Score j of the residual at controls c: V_j . (lids from rest - basis (e - e_rest)). */
static double score(const struct rig_motion *m, const struct skin_model *model, const struct poses *p, const double *V, int j, const double *c)
{
	double *l = mem_new((size_t)p->n_lid + 1, sizeof *l), e[RIG_COMPONENTS], sum = 0;
	lids_of(l, model, c);
	rig_motion_components(e, m, c);
	for (int i = 0; i < p->n_lid; i++) {
		double left = finite_or(l[i] - p->rest[i], 0);
		for (int k = 0; k < RIG_SKIN_COMPONENTS; k++)
			left -= m->lid_basis[i / 2][i % 2 * RIG_COMPONENTS + k] * (e[k] - p->rest_e[k]);
		sum += V[i * RIG_LID_COMPONENTS + j] * left;
	}
	free(l);
	return sum;
}

/* Adds the lids' own rows of W, from scores at unit controls (they are affine), and their columns of the basis. */
static void add_components(struct rig_motion *m, const struct skin_model *model, struct poses *p, const double *V)
{
	int n = m->n_inputs;
	double *c = mem_new((size_t)n + 1, sizeof *c);
	for (int j = 0; j < RIG_LID_COMPONENTS; j++) {
		double *row = m->W + (RIG_SKIN_COMPONENTS + j) * (n + 1);
		row[n] = score(m, model, p, V, j, c);
		for (int i = 0; i < n; i++) {
			c[i] = 1;
			row[i] = score(m, model, p, V, j, c) - row[n];
			c[i] = 0;
		}
	}
	for (int i = 0; i < p->n_lid; i++)
		memcpy(m->lid_basis[i / 2] + i % 2 * RIG_COMPONENTS + RIG_SKIN_COMPONENTS, V + i * RIG_LID_COMPONENTS,
		       RIG_LID_COMPONENTS * sizeof *V);
	free(c);
}

/* Subtracts the lids' own components from p->l. */
static void subtract(struct poses *p, const double *V)
{
	for (int i = 0; i < p->n; i++) {
		double *l = p->l + (size_t)i * (size_t)p->n_lid;
		for (int j = 0; j < RIG_LID_COMPONENTS; j++) {
			double s = 0;
			for (int k = 0; k < p->n_lid; k++)
				s += V[k * RIG_LID_COMPONENTS + j] * l[k];
			for (int k = 0; k < p->n_lid; k++)
				l[k] -= V[k * RIG_LID_COMPONENTS + j] * s;
		}
	}
}

void rig_motion_take_lids(struct rig_motion *m, const struct skin_model *model, const double *rest)
{
	struct poses p = { .n_inputs = model->n_inputs, .n_lid = model->n_lid };
	double *V = mem_new((size_t)model->n_lid * RIG_LID_COMPONENTS + 1, sizeof *V);
	p.rest = mem_new((size_t)model->n_lid + 1, sizeof *p.rest);
	lids_of(p.rest, model, rest);
	memcpy(p.rest_e, m->rest_e, sizeof p.rest_e);
	for (int i = 0; i < model->n_lid; i++)
		m->lid[i / 2][i % 2] = p.rest[i];
	gather(&p, model);
	evaluate(&p, m, model);
	regress_on_skin(m, &p);
	m->lid_error_skin = rms(&p);
	directions(V, &p);
	add_components(m, model, &p, V);
	subtract(&p, V);
	m->lid_error = rms(&p);
	rig_motion_components(m->rest_e, m, rest);
	free(p.c);
	free(p.e);
	free(p.l);
	free(p.rest);
	free(V);
}
