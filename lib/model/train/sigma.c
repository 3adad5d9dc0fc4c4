/* Standard errors by the delete-a-block jackknife (Tukey; Kuensch 1989 for dependent data): the model is fitted again to the sample
 * without each block of time in turn. Neighbouring frames fall into the same block, so they do not count as independent
 * measurements. The frames left out also give each vertex's held-out error. */
#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "model/train/impl.h"

enum { GROUPS = 20 };

/* Sums over the replicates of n numbers. */
struct jack {
	size_t n;
	int count;
	double *sum, *squares;
};

static struct jack jack_new(size_t n)
{
	return (struct jack){ n, 0, mem_new(n + 1, sizeof(double)), mem_new(n + 1, sizeof(double)) };
}

/* Adds a replicate x[n], relative to `origin` so that squares of large means cost no digits. */
static void jack_add(struct jack *j, const double *x, const double *origin)
{
	for (size_t i = 0; i < j->n; i++) {
		double d = x[i] - (isnan(origin[i]) ? 0 : origin[i]);
		j->sum[i] += d;
		j->squares[i] += d * d;
	}
	j->count++;
}

static void jack_sigma(double *sigma, struct jack *j)
{
	double n = j->count;
	for (size_t i = 0; i < j->n; i++)
		sigma[i] = n > 1 ? sqrt(fmax(0, j->squares[i] - j->sum[i] * j->sum[i] / n) * (n - 1) / n) : NAN;
	free(j->sum);
	free(j->squares);
}

/* One part of the sample: regressors and scores, and the results of one replicate. */
struct replica {
	int q, R, kept;
	double *x, *s;              // [m][q], [m][R]
	double *b, *mx, *my;        // [kept][q], [q], [R]
	double *V, *sd, *mean;      // [n][kept], [kept], [n]
	struct jack V_jack, sd_jack, mean_jack;
};

static struct replica replica_new(const struct train *t, int p)
{
	const struct part *part = &t->part[p];
	long m = t->n_sample;
	int n = part->n, kept = t->part[p].kept;
	struct replica r = { .R = part->k_max, .kept = kept };
	r.x = train_regressors(t, p, &r.q);
	r.s = mem_new((size_t)m * (size_t)r.R + 1, sizeof *r.s);
	double *y = mem_array((size_t)m * (size_t)n + 1, sizeof *y);
	for (long i = 0; i < m; i++)
		for (int c = 0; c < n; c++)
			y[i * n + c] = part->x[i * n + c] - part->sum.mean[part->from + c];
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)m, r.R, n, 1, y, n, part->V_all, r.R, 0, r.s, r.R);
	free(y);
	r.b = mem_new((size_t)(r.R * r.q) + 1, sizeof *r.b);
	r.mx = mem_new((size_t)r.q + 1, sizeof *r.mx);
	r.my = mem_new((size_t)r.R + 1, sizeof *r.my);
	r.V = mem_new((size_t)(n * kept) + 1, sizeof *r.V);
	r.sd = mem_new((size_t)kept + 1, sizeof *r.sd);
	r.mean = mem_new((size_t)n + 1, sizeof *r.mean);
	r.V_jack = jack_new((size_t)(n * kept));
	r.sd_jack = jack_new((size_t)kept);
	r.mean_jack = jack_new((size_t)n);
	return r;
}

static void replica_free(struct replica *r)
{
	free(r->x);
	free(r->s);
	free(r->b);
	free(r->mx);
	free(r->my);
	free(r->V);
	free(r->sd);
	free(r->mean);
}

/* Principal components without the block, from the scores' moments G; signs as in the whole clip's. */
static void refit_components(struct replica *r, const struct part *part, double *G, double weight)
{
	int R = r->R, n = part->n, k = r->kept < R ? r->kept : R;
	double *d = mem_new((size_t)R + 1, sizeof *d), *z = mem_new((size_t)(R * k) + 1, sizeof *z);
	LAPACKE_dsyevd(LAPACK_ROW_MAJOR, 'V', 'L', R, G, R, d);
	for (int c = 0; c < k; c++) {
		double sign = G[c * R + R - 1 - c] < 0 ? -1 : 1;
		for (int i = 0; i < R; i++)
			z[i * k + c] = d[R - 1 - c] > train_rounding(R, d[R - 1]) ? sign * G[i * R + R - 1 - c] : 0;
		r->sd[c] = sqrt(fmax(0, d[R - 1 - c]) / weight);
	}
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n, k, R, 1, part->V_all, R, z, k, 0, r->V, r->kept);
	free(d);
	free(z);
}

/* Fits the part to the frames with weights w. */
static void refit(struct replica *r, const struct train *t, int p, const double *w)
{
	const struct part *part = &t->part[p];
	int q = r->q, R = r->R;
	double *Gxx = mem_new((size_t)(q * q) + 1, sizeof *Gxx), *Gxy = mem_new((size_t)(q * R) + 1, sizeof *Gxy);
	double *G = mem_new((size_t)(R * R) + 1, sizeof *G), *G2 = mem_new((size_t)(R * R) + 1, sizeof *G2);
	double *again = mem_new((size_t)R + 1, sizeof *again);
	regress_moments(G, G2, r->my, again, t->n_sample, R, R, r->s, r->s, w);
	double weight = regress_moments(Gxx, Gxy, r->mx, r->my, t->n_sample, q, R, r->x, r->s, w);
	regress(r->b, q, R, Gxx, Gxy, weight, r->mx, part->ridge);
	refit_components(r, part, G, weight);
	for (int i = 0; i < part->n; i++) {
		r->mean[i] = part->sum.mean[part->from + i];
		for (int c = 0; c < R; c++)
			r->mean[i] += part->V_all[i * R + c] * r->my[c];
	}
	free(Gxx);
	free(Gxy);
	free(G);
	free(G2);
	free(again);
}

static void add_replica(struct replica *r, const struct train *t, int p)
{
	const struct part *part = &t->part[p];
	double *V = mem_new((size_t)(part->n * r->kept) + 1, sizeof *V);
	for (int i = 0; i < part->n; i++)
		for (int c = 0; c < r->kept && c < part->k_max; c++)
			V[i * r->kept + c] = part->V_all[i * part->k_max + c];
	jack_add(&r->V_jack, r->V, V);
	jack_add(&r->sd_jack, r->sd, part->sd_all);
	jack_add(&r->mean_jack, r->mean, part->sum.mean + part->from);
	free(V);
}

/* Adds each vertex's weighted squared error in the frames left out, with the components kept. */
static void add_vertex_errors(double *error, double *weight, const struct train *t, const struct replica *r, const bool *out)
{
	const struct part *part = &t->part[TRAIN_SKIN];
	int n = part->n, k = r->kept;
	double *e = mem_new((size_t)k + 1, sizeof *e);
	for (long i = 0; i < t->n_sample; i++) {
		if (!out[i] || !(part->w[i] > 0))
			continue;
		for (int c = 0; c < k; c++) {
			e[c] = r->my[c];
			for (int a = 0; a < r->q; a++)
				e[c] += r->b[c * r->q + a] * (r->x[i * r->q + a] - r->mx[a]);
		}
		for (int v = 0; v < n; v++) {
			double d = part->x[i * n + v] - part->sum.mean[part->from + v];
			for (int c = 0; c < k; c++)
				d -= part->V_all[v * part->k_max + c] * e[c];
			error[v / 2] += part->w[i] * d * d;
		}
		*weight += part->w[i];
	}
	free(e);
}

/* Standard errors of components and means into the model. */
static void collect(struct train *t, struct replica *r)
{
	struct skin_model *m = t->model;
	int kl = m->n_lid_pc / 2, ne = m->n_skin_pc;
	for (int p = 0; p < TRAIN_PARTS; p++) {
		int n = t->part[p].n, k = r[p].kept;
		if (!t->part[p].used)
			continue;
		double *V = mem_new((size_t)(n * k) + 1, sizeof *V);
		jack_sigma(V, &r[p].V_jack);
		for (int i = 0; i < n; i++)
			for (int c = 0; c < k; c++)
				*(p == TRAIN_SKIN ? &m->J_sigma[i * ne + c]
				                  : &m->K_sigma[(size_t)(p * n + i) * (size_t)m->n_lid_pc + (size_t)(p * kl + c)])
				        = V[i * k + c];
		jack_sigma(p == TRAIN_SKIN ? m->skin_pc_sigma : m->lid_pc_sigma + p * kl, &r[p].sd_jack);
		jack_sigma(p == TRAIN_SKIN ? m->u0_sigma : m->l0_sigma + p * n, &r[p].mean_jack);
		free(V);
	}
}

void train_sigmas(struct train *t)
{
	struct skin_model *m = t->model, again = *m;  // again: the same components with the replicate's regressions
	int groups = (int)fmin(GROUPS, (double)t->n_sample / 4), nW = m->n_skin_pc * (m->n_inputs + 1);
	size_t nL = (size_t)(m->n_lid_pc * (SKIN_EYE_INPUTS + 1)), nM = (size_t)(m->n_skin_pc * (m->n_lid + m->n_au + 1));
	double *W = mem_new((size_t)nW + 1, sizeof *W), *W0 = mem_new((size_t)nW + 1, sizeof *W0), seen = 0;
	double *w = mem_new((size_t)t->n_sample + 1, sizeof *w);
	bool *out = mem_new((size_t)t->n_sample + 1, sizeof *out);
	struct replica r[TRAIN_PARTS] = { 0 };
	struct jack L = jack_new(nL), M = jack_new(nM), fold = jack_new((size_t)nW);
	again.L = mem_new(nL + 1, sizeof *again.L);
	again.M = mem_new(nM + 1, sizeof *again.M);
	skin_model_fold(W0, m);
	for (int p = 0; p < TRAIN_PARTS; p++)
		if (t->part[p].used)
			r[p] = replica_new(t, p);
	for (int g = 0; g < groups; g++) {
		for (long i = 0; i < t->n_sample; i++)
			out[i] = i * groups / t->n_sample == g;
		for (int p = 0; p < TRAIN_PARTS; p++) {
			if (!t->part[p].used)
				continue;
			for (long i = 0; i < t->n_sample; i++)
				w[i] = out[i] ? 0 : t->part[p].w[i];
			refit(&r[p], t, p, w);
			add_replica(&r[p], t, p);
			if (p != TRAIN_SKIN)
				train_set_L(&again, p, r[p].b, r[p].mx, r[p].my);
		}
		train_set_M(&again, r[TRAIN_SKIN].b, r[TRAIN_SKIN].mx, r[TRAIN_SKIN].my);
		add_vertex_errors(m->vertex_rms, &seen, t, &r[TRAIN_SKIN], out);
		skin_model_fold(W, &again);
		jack_add(&L, again.L, m->L);
		jack_add(&M, again.M, m->M);
		jack_add(&fold, W, W0);
	}
	jack_sigma(m->L_sigma, &L);
	jack_sigma(m->M_sigma, &M);
	jack_sigma(m->W_sigma, &fold);
	collect(t, r);
	for (int v = 0; v < m->n_vertices; v++)
		m->vertex_rms[v] = t->part[TRAIN_SKIN].seen[2 * v] && seen > 0 ? sqrt(m->vertex_rms[v] / seen / 2) : NAN;
	for (int p = 0; p < TRAIN_PARTS; p++)
		replica_free(&r[p]);
	free(again.L);
	free(again.M);
	free(W);
	free(W0);
	free(w);
	free(out);
}
