/* Components and regressions of the whole clip, from its scatters. */
#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "model/train/cv.h"

enum { MOST_COMPONENTS = 40 };

/* A part's principal components (V_all, sd_all), and what the report says of them. */
static void components(struct train *t, int p)
{
	struct part *part = &t->part[p];
	struct train_report *r = t->report;
	int kept = t->part[p].kept;
	part->k_max = (int)fmin(fmin(part->n, MOST_COMPONENTS), (double)part->sum.n);
	part->k_max = part->k_max < kept ? kept : part->k_max;
	part->k_max = part->k_max > part->n ? part->n : part->k_max;
	part->V_all = mem_new((size_t)part->n * (size_t)part->k_max + 1, sizeof *part->V_all);
	part->sd_all = mem_new((size_t)part->k_max + 1, sizeof *part->sd_all);
	part->rank = scatter_components(part->V_all, part->sd_all, &part->sum, part->from, part->n, part->k_max);
	double energy = scatter_energy(&part->sum, part->from, part->n), sum = 0;
	for (int k = 0; k < part->k_max; k++) {
		sum += part->sd_all[k] * part->sd_all[k];
		r->components95[p] += sum < 0.95 * energy;
		r->components99[p] += sum < 0.99 * energy;
		part->sd_all[k] /= sqrt(part->sum.weight);
	}
	r->components95[p] += energy > 0;
	r->components99[p] += energy > 0;
	r->rank[p] = part->rank;
	r->used[p] = part->sum.n;
	r->outlying[p] = part->used_frames ? (double)part->outlying / (double)part->used_frames : 0;
	r->filled[p] = part->numbers > 0 ? part->filled / part->numbers : 0;
}

void train_set_L(struct skin_model *m, int eye, const double *b, const double *mx, const double *my)
{
	int kl = m->n_lid_pc / 2;
	for (int k = 0; k < kl; k++) {
		double *row = m->L + (eye * kl + k) * (SKIN_EYE_INPUTS + 1);
		memset(row, 0, (SKIN_EYE_INPUTS + 1) * sizeof *row);
		row[SKIN_EYE_INPUTS] = my[k];
		for (int i = 0; i < EYE_INPUTS; i++) {
			row[EYE_INPUTS * eye + i] = b[k * EYE_INPUTS + i];
			row[SKIN_EYE_INPUTS] -= b[k * EYE_INPUTS + i] * mx[i];
		}
	}
}

void train_set_M(struct skin_model *m, const double *b, const double *mx, const double *my)
{
	int q = m->n_lid_pc + m->n_au, columns = m->n_lid + m->n_au + 1;
	memset(m->M, 0, (size_t)(m->n_skin_pc * columns) * sizeof *m->M);
	for (int e = 0; e < m->n_skin_pc; e++) {
		double *row = m->M + (size_t)e * (size_t)columns, constant = my[e];
		const double *be = b + e * q;
		for (int i = 0; i < m->n_lid; i++) {
			for (int c = 0; c < m->n_lid_pc; c++)
				row[i] += be[c] * m->K[(size_t)i * (size_t)m->n_lid_pc + (size_t)c];
			constant -= row[i] != 0 ? row[i] * m->l0[i] : 0;
		}
		memcpy(row + m->n_lid, be + m->n_lid_pc, (size_t)m->n_au * sizeof *row);
		for (int c = 0; c < q; c++)
			constant -= be[c] * mx[c];
		row[columns - 1] = constant;
	}
}

static void fit_lids(struct train *t, int eye)
{
	struct skin_model *m = t->model;
	struct part *part = &t->part[eye];
	int kl = m->n_lid_pc / 2, n = part->n;
	for (int i = 0; i < n; i++) {
		m->l0[eye * n + i] = part->used && part->seen[i] ? part->sum.mean[part->from + i] : NAN;
		m->l0_sigma[eye * n + i] = NAN;
		for (int k = 0; k < kl && part->used; k++)
			m->K[(size_t)(eye * n + i) * (size_t)m->n_lid_pc + (size_t)(eye * kl + k)] = part->V_all[i * part->k_max + k];
	}
	if (!part->used)
		return;
	memcpy(m->lid_pc + eye * kl, part->sd_all, (size_t)kl * sizeof *m->lid_pc);
	train_validate(t, eye);
	double Gxx[EYE_INPUTS * EYE_INPUTS], *Gxu = mem_new((size_t)(EYE_INPUTS * n) + 1, sizeof *Gxu);
	double *Gxy = mem_new((size_t)(EYE_INPUTS * kl) + 1, sizeof *Gxy), *b = mem_new((size_t)(EYE_INPUTS * kl) + 1, sizeof *b);
	double *zero = mem_new((size_t)kl + 1, sizeof *zero);
	scatter_cross(Gxx, &part->sum, 0, EYE_INPUTS, 0, EYE_INPUTS);
	scatter_cross(Gxu, &part->sum, 0, EYE_INPUTS, part->from, n);
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, EYE_INPUTS, kl, n, 1, Gxu, n, part->V_all, part->k_max, 0, Gxy, kl);
	part->rank_inputs = regress(b, EYE_INPUTS, kl, Gxx, Gxy, part->sum.weight, part->sum.mean, part->ridge);
	t->report->rank_inputs[eye] = part->rank_inputs;
	train_set_L(m, eye, b, part->sum.mean, zero);
	free(Gxu);
	free(Gxy);
	free(b);
	free(zero);
}

/* Lid components with a standard deviation below 1e-7 of the largest are lost in the rounding of squares and would get slopes of any
 * size: they are taken out of the skin's regression. */
static void leave_unresolved(double *Gxx, double *Gxy, int n_lid_pc, int q, int ne)
{
	const double least = 1e-7;
	double top = 0;
	for (int i = 0; i < n_lid_pc; i++)
		top = fmax(top, Gxx[i * q + i]);
	for (int i = 0; i < n_lid_pc; i++) {
		if (Gxx[i * q + i] > least * least * top)
			continue;
		for (int j = 0; j < q; j++)
			Gxx[i * q + j] = Gxx[j * q + i] = 0;
		memset(Gxy + i * ne, 0, (size_t)ne * sizeof *Gxy);
	}
}

/* Centred cross moments of the regressors [lid scores, action units] with themselves (Gxx) and with the skin's scores (Gxy); means mx
 * of the regressors. */
static void skin_moments(double *Gxx, double *Gxy, double *mx, const struct train *t)
{
	const struct skin_model *m = t->model;
	const struct part *part = &t->part[TRAIN_SKIN];
	int q = m->n_lid_pc + m->n_au, wide = m->n_lid + m->n_au, n = part->n, ne = m->n_skin_pc;
	double *T = mem_new((size_t)(wide * q) + 1, sizeof *T), *G = mem_new((size_t)(wide * wide) + 1, sizeof *G);
	double *U = mem_new((size_t)wide * (size_t)n + 1, sizeof *U), *UJ = mem_new((size_t)(wide * ne) + 1, sizeof *UJ);
	double *GT = mem_new((size_t)(wide * q) + 1, sizeof *GT);
	for (int i = 0; i < m->n_lid; i++)
		memcpy(T + i * q, m->K + (size_t)i * (size_t)m->n_lid_pc, (size_t)m->n_lid_pc * sizeof *T);
	for (int a = 0; a < m->n_au; a++)
		T[(m->n_lid + a) * q + m->n_lid_pc + a] = 1;
	scatter_cross(G, &part->sum, 0, wide, 0, wide);
	scatter_cross(U, &part->sum, 0, wide, part->from, n);
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, wide, q, wide, 1, G, wide, T, q, 0, GT, q);
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, q, q, wide, 1, T, q, GT, q, 0, Gxx, q);
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, wide, ne, n, 1, U, n, m->J, ne, 0, UJ, ne);
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, q, ne, wide, 1, T, q, UJ, ne, 0, Gxy, ne);
	memset(mx, 0, (size_t)q * sizeof *mx);
	for (int i = 0; i < wide; i++)
		for (int c = 0; c < q; c++) {
			double l0 = i < m->n_lid && !isnan(m->l0[i]) ? m->l0[i] : 0;
			mx[c] += T[i * q + c] * (part->sum.mean[i] - l0);
		}
	free(T);
	free(G);
	free(U);
	free(UJ);
	free(GT);
}

static void fit_skin(struct train *t)
{
	struct skin_model *m = t->model;
	struct part *part = &t->part[TRAIN_SKIN];
	if (!part->used)
		return;
	train_choose_skin(t);
	int n = part->n, ne = m->n_skin_pc, q = m->n_lid_pc + m->n_au;
	if (part->sum.n <= q)
		train_warn(t, "%s: %ld frames show the skin, no more than the %d numbers it is foretold from: film longer", t->clip->place, part->sum.n, q);
	for (int i = 0; i < n; i++) {
		m->u0[i] = part->seen[i] ? part->sum.mean[part->from + i] : NAN;
		t->report->unseen_vertices += i % 2 == 0 && !part->seen[i];
		for (int k = 0; k < ne; k++)
			m->J[i * ne + k] = part->V_all[i * part->k_max + k];
	}
	memcpy(m->skin_pc, part->sd_all, (size_t)ne * sizeof *m->skin_pc);
	train_validate(t, TRAIN_SKIN);
	double *Gxx = mem_new((size_t)(q * q) + 1, sizeof *Gxx), *Gxy = mem_new((size_t)(q * ne) + 1, sizeof *Gxy);
	double *mx = mem_new((size_t)q + 1, sizeof *mx), *b = mem_new((size_t)(q * ne) + 1, sizeof *b);
	double *zero = mem_new((size_t)ne + 1, sizeof *zero);
	skin_moments(Gxx, Gxy, mx, t);
	leave_unresolved(Gxx, Gxy, m->n_lid_pc, q, ne);
	part->rank_inputs = regress(b, q, ne, Gxx, Gxy, part->sum.weight, mx, part->ridge);
	t->report->rank_inputs[TRAIN_SKIN] = part->rank_inputs;
	train_set_M(m, b, mx, zero);
	free(Gxx);
	free(Gxy);
	free(mx);
	free(b);
	free(zero);
}

/* Largest difference, px, between the folded equation 3.9 and equations 3.7, 3.2 and 3.3 one after the other, over the sample's
 * controls. */
static double folding_error(const struct train *t)
{
	const struct skin_model *m = t->model;
	int n = m->n_inputs, nu = 2 * m->n_vertices;
	double *W = mem_new((size_t)(m->n_skin_pc * (n + 1)) + 1, sizeof *W), *u = mem_new((size_t)nu + 1, sizeof *u);
	double *c = mem_new((size_t)n + 1, sizeof *c), *e = mem_new((size_t)m->n_skin_pc + 1, sizeof *e), worst = 0;
	skin_model_fold(W, m);
	long step = 1 + t->n_sample / 256;
	for (long i = 0; i < t->n_sample; i += step) {
		skin_model_controls(c, m, t->g + t->sample[i] * n);
		for (int k = 0; k < n; k++)
			c[k] = isnan(c[k]) ? 0 : c[k];
		skin_model_predict(u, 0, m, c);
		for (int r = 0; r < m->n_skin_pc; r++) {
			e[r] = W[r * (n + 1) + n];
			for (int k = 0; k < n; k++)
				e[r] += W[r * (n + 1) + k] * c[k];
		}
		for (int v = 0; v < nu; v++) {
			double folded = m->u0[v];
			for (int r = 0; r < m->n_skin_pc; r++)
				folded += m->J[v * m->n_skin_pc + r] * e[r];
			worst = isnan(folded) ? worst : fmax(worst, fabs(folded - u[v]));
		}
	}
	free(W);
	free(u);
	free(c);
	free(e);
	return worst;
}

/* Controls and components of the reference frame. */
static void at_rest(struct train *t)
{
	struct skin_model *m = t->model;
	double *x[TRAIN_PARTS], *c[TRAIN_PARTS], d, share;
	struct err err = { 0 };
	for (int p = 0; p < TRAIN_PARTS; p++) {
		x[p] = mem_new((size_t)t->part[p].n + 1, sizeof(double));
		c[p] = mem_new((size_t)t->part[p].n + 1, sizeof(double));
	}
	skin_model_controls(m->rest_controls, m, t->g + t->clip->reference * m->n_inputs);
	for (int i = 0; i < m->n_inputs; i++)
		m->rest_controls[i] = isnan(m->rest_controls[i]) ? 0 : m->rest_controls[i];
	struct part *skin = &t->part[TRAIN_SKIN];
	if (train_read(t, t->clip->reference, 1, x, c, &err)) {
		part_complete(skin, 1, x[TRAIN_SKIN], c[TRAIN_SKIN], &d, &share);
		for (int i = 0; i < skin->n; i++)
			for (int r = 0; r < m->n_skin_pc && skin->seen[i]; r++)
				m->rest_e[r] += m->J[i * m->n_skin_pc + r] * (x[TRAIN_SKIN][i] - m->u0[i]);
	}
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(x[p]);
		free(c[p]);
	}
}

void train_fit(struct train *t)
{
	for (int p = 0; p < TRAIN_PARTS; p++)
		if (t->part[p].used)
			components(t, p);
	train_choose_lids(t);
	fit_lids(t, TRAIN_LEFT);
	fit_lids(t, TRAIN_RIGHT);
	fit_skin(t);
	at_rest(t);
	t->report->folding_px = folding_error(t);
}
