#include "model/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"

enum { EYE_INPUTS = SKIN_EYE_INPUTS / 2 };

static double *numbers(int rows, int columns)
{
	return mem_new((size_t)rows * (size_t)columns + 1, sizeof(double));
}

struct skin_eyes skin_eyes_unknown(void)
{
	struct skin_eyes out;
	double *x = &out.center[0][0];
	for (size_t i = 0; i < sizeof out / sizeof *x; i++)
		x[i] = NAN;
	return out;
}

void skin_model_alloc(struct skin_model *m)
{
	m->n_inputs = SKIN_EYE_INPUTS + m->n_au;
	m->n_lid = SKIN_LIDS * m->n_points * 2;
	m->eyes = skin_eyes_unknown();
	int u = 2 * m->n_vertices, from = m->n_lid + m->n_au + 1;
	m->au_names = mem_new((size_t)m->n_au + 1, sizeof *m->au_names);
	m->vertices = mem_new((size_t)m->n_vertices + 1, sizeof *m->vertices);
	m->l0 = numbers(m->n_lid, 1);
	m->l0_sigma = numbers(m->n_lid, 1);
	m->K = numbers(m->n_lid, m->n_lid_pc);
	m->K_sigma = numbers(m->n_lid, m->n_lid_pc);
	m->L = numbers(m->n_lid_pc, SKIN_EYE_INPUTS + 1);
	m->L_sigma = numbers(m->n_lid_pc, SKIN_EYE_INPUTS + 1);
	m->u0 = numbers(u, 1);
	m->u0_sigma = numbers(u, 1);
	m->J = numbers(u, m->n_skin_pc);
	m->J_sigma = numbers(u, m->n_skin_pc);
	m->M = numbers(m->n_skin_pc, from);
	m->M_sigma = numbers(m->n_skin_pc, from);
	m->W_sigma = numbers(m->n_skin_pc, m->n_inputs + 1);
	m->lid_pc = numbers(m->n_lid_pc, 1);
	m->lid_pc_sigma = numbers(m->n_lid_pc, 1);
	m->skin_pc = numbers(m->n_skin_pc, 1);
	m->skin_pc_sigma = numbers(m->n_skin_pc, 1);
	m->vertex_rms = numbers(m->n_vertices, 1);
	m->lid_reach = numbers(2 * EYE_INPUTS, EYE_INPUTS + 1);
	m->skin_reach = numbers(m->n_inputs, m->n_inputs + 1);
	m->low = numbers(m->n_inputs, 1);
	m->high = numbers(m->n_inputs, 1);
	m->mean = numbers(m->n_inputs, 1);
	m->rest_controls = numbers(m->n_inputs, 1);
	m->rest_e = numbers(m->n_skin_pc, 1);
	m->expression = mem_new((size_t)m->n_au + 1, sizeof *m->expression);
	m->expression_sigma = mem_new((size_t)m->n_au + 1, sizeof *m->expression_sigma);
	known_all(&m->known);
}

void skin_model_free(struct skin_model *m)
{
	for (int i = 0; m->au_names && i < m->n_au; i++)
		free(m->au_names[i]);
	free(m->au_names);
	free(m->vertices);
	double *const all[] = { m->l0,     m->l0_sigma, m->K,      m->L,            m->L_sigma, m->u0,
		                    m->u0_sigma, m->J,      m->M,      m->M_sigma,      m->lid_pc,  m->lid_pc_sigma,
		                    m->skin_pc,  m->skin_pc_sigma, m->vertex_rms, m->low, m->high,  m->mean,
		                    m->rest_controls, m->rest_e, m->K_sigma, m->J_sigma, m->W_sigma,
		                    m->lid_reach, m->skin_reach };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	free(m->expression);
	free(m->expression_sigma);
	*m = (struct skin_model){ 0 };
}

void skin_model_inputs(double *g, const struct skin_model *m, const double *controls)
{
	for (int i = 0; i < m->n_inputs; i++) {
		bool aperture = i < SKIN_EYE_INPUTS && i % 5 >= 3;
		g[i] = aperture ? m->closed[i] + (m->open[i] - m->closed[i]) * controls[i] : controls[i];
	}
}

void skin_model_controls(double *controls, const struct skin_model *m, const double *g)
{
	for (int i = 0; i < m->n_inputs; i++) {
		bool aperture = i < SKIN_EYE_INPUTS && i % 5 >= 3;
		double range = aperture ? m->open[i] - m->closed[i] : 1;
		controls[i] = !aperture ? g[i] : range != 0 ? (g[i] - m->closed[i]) / range : 0;
	}
}

/* out[rows] = A[rows][columns + 1] [x; 1]. Where a coefficient is 0, x may be NAN. */
static void affine(double *out, int rows, int columns, const double *A, const double *x)
{
	for (int r = 0; r < rows; r++) {
		const double *a = A + (size_t)r * (size_t)(columns + 1);
		double sum = a[columns];
		for (int c = 0; c < columns; c++)
			sum += a[c] != 0 ? a[c] * x[c] : 0;
		out[r] = sum;
	}
}

/* out[rows] = mean + A[rows][columns] x */
static void expand(double *out, int rows, int columns, const double *mean, const double *A, const double *x)
{
	for (int r = 0; r < rows; r++) {
		double sum = mean[r];
		for (int c = 0; c < columns; c++)
			sum += A[(size_t)r * (size_t)columns + (size_t)c] * x[c];
		out[r] = sum;
	}
}

void skin_model_lids(double *l, const struct skin_model *m, const double *g)
{
	double *pc = numbers(m->n_lid_pc, 1);
	affine(pc, m->n_lid_pc, SKIN_EYE_INPUTS, m->L, g);
	expand(l, m->n_lid, m->n_lid_pc, m->l0, m->K, pc);
	free(pc);
}

void skin_model_skin(double *u, double *e, const struct skin_model *m, const double *l, const double *au)
{
	double *from = numbers(m->n_lid + m->n_au, 1), *pc = e ? e : numbers(m->n_skin_pc, 1);
	memcpy(from, l, (size_t)m->n_lid * sizeof *from);
	if (m->n_au)
		memcpy(from + m->n_lid, au, (size_t)m->n_au * sizeof *from);
	affine(pc, m->n_skin_pc, m->n_lid + m->n_au, m->M, from);
	expand(u, 2 * m->n_vertices, m->n_skin_pc, m->u0, m->J, pc);
	free(from);
	if (!e)
		free(pc);
}

void skin_model_predict(double *u, double *l, const struct skin_model *m, const double *controls)
{
	double *g = numbers(m->n_inputs, 1), *lids = l ? l : numbers(m->n_lid, 1);
	skin_model_inputs(g, m, controls);
	skin_model_lids(lids, m, g);
	skin_model_skin(u, 0, m, lids, g + SKIN_EYE_INPUTS);
	free(g);
	if (!l)
		free(lids);
}

void skin_model_fold(double *W, const struct skin_model *m)
{
	int n = m->n_inputs, from = m->n_lid + m->n_au;
	// Lids as an affine function of the controls: column by column of [c; 1].
	double *H = numbers(m->n_lid, SKIN_EYE_INPUTS + 1);
	for (int i = 0; i < m->n_lid; i++)
		for (int k = 0; k < m->n_lid_pc; k++) {
			double Kik = m->K[(size_t)i * (size_t)m->n_lid_pc + (size_t)k];
			for (int c = 0; c <= SKIN_EYE_INPUTS; c++)
				H[i * (SKIN_EYE_INPUTS + 1) + c] += Kik * m->L[k * (SKIN_EYE_INPUTS + 1) + c];
		}
	for (int i = 0; i < m->n_lid; i++) {
		double *h = H + i * (SKIN_EYE_INPUTS + 1);
		h[SKIN_EYE_INPUTS] += isnan(m->l0[i]) ? 0 : m->l0[i];
		for (int c = 0; c < SKIN_EYE_INPUTS; c++)
			if (c % 5 >= 3) {
				h[SKIN_EYE_INPUTS] += h[c] * m->closed[c];
				h[c] *= m->open[c] - m->closed[c];
			}
	}
	for (int r = 0; r < m->n_skin_pc; r++) {
		const double *M = m->M + (size_t)r * (size_t)(from + 1);
		double *w = W + r * (n + 1);
		memset(w, 0, (size_t)(n + 1) * sizeof *w);
		for (int i = 0; i < m->n_lid; i++)
			for (int c = 0; c <= SKIN_EYE_INPUTS; c++)
				w[c < SKIN_EYE_INPUTS ? c : n] += M[i] * H[i * (SKIN_EYE_INPUTS + 1) + c];
		for (int a = 0; a < m->n_au; a++)
			w[SKIN_EYE_INPUTS + a] = M[m->n_lid + a];
		w[n] += M[from];
	}
	free(H);
}

void skin_model_leverage(double h[3], const struct skin_model *m, const double *g)
{
	for (int eye = 0; eye < 2; eye++)
		h[eye] = regress_leverage(m->lid_reach + eye * EYE_INPUTS * (EYE_INPUTS + 1), EYE_INPUTS, g + EYE_INPUTS * eye);
	h[2] = regress_leverage(m->skin_reach, m->n_inputs, g);
}

void skin_model_baseline(double control[2], const struct skin_model *m, int eye, double c, double g1, double g2)
{
	double gaze[3] = { g1, g2, 0 };
	known_hold(gaze, &m->known, eye);
	for (int lid = 0; lid < 2; lid++) {
		const double *a = m->baseline[eye][lid];
		control[lid] = c * (a[0] * gaze[0] + a[1] * gaze[1] + a[2]);
	}
}

void skin_model_range(double px[EXPRESS_LIDS], const struct skin_model *m)
{
	for (int k = 0; k < EXPRESS_LIDS; k++) {
		int at = k / 2 * EYE_INPUTS + 3 + k % 2;
		px[k] = m->open[at] - m->closed[at];
	}
}

void skin_model_express(double *controls, const struct skin_model *m, const double c[2])
{
	double px[EXPRESS_LIDS];
	skin_model_range(px, m);
	for (int eye = 0; eye < 2; eye++)
		express_eye(controls + EYE_INPUTS * eye + 3, eye, m->n_au, controls + SKIN_EYE_INPUTS, (const double(*)[EXPRESS_LIDS])m->expression, px, c[eye]);
}
