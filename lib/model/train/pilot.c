/* The pilot of a part: a robust principal component basis by iteratively reweighted least squares. Spherical components give the first
 * weights; in each step missing numbers are filled in and frames far from the components weigh less. */
#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "model/train/impl.h"

enum { IRLS_STEPS = 10 };
static const double settled = 0.01;  // largest change of a weight at which the iteration ends
static const double smallest_distance = 1e-4;  // over the motion's size: nearer, frames agree to the rounding of their files

/* Interpolates gaps of one coordinate over time: the first guess of the missing numbers. */
static void bridge(const struct part *p, int i, long m, double *x, const double *c)
{
	long before = -1, n = p->n;
	for (long r = 0; r <= m; r++) {
		if (r < m && !(c[r * n + i] > 0))
			continue;
		for (long k = before + 1; k < r; k++) {
			double a = before < 0 ? 1 : r == m ? 0 : (double)(k - before) / (double)(r - before);
			x[k * n + i] = (a < 1 ? (1 - a) * x[before * n + i] : 0) + (a > 0 ? a * x[r * n + i] : 0);
		}
		before = r;
	}
}

/* Finds the coordinates that are measured often enough and starts at their medians; the others become 0 and stay so. */
static void begin_pilot(struct part *p, long m, double *x, double *c, const struct train_conf *conf)
{
	double *column = mem_array((size_t)m + 1, sizeof *column);
	for (int i = 0; i < p->n; i++) {
		int n = 0;
		for (long r = 0; r < m; r++)
			if (c[r * p->n + i] > 0)
				column[n++] = x[r * p->n + i];
		p->seen[i] = n > 0 && n >= conf->min_seen * (double)m;
		p->mean[i] = p->seen[i] ? stats_median(n, column) : 0;
		for (long r = 0; r < m && !p->seen[i]; r++)
			c[r * p->n + i] = x[r * p->n + i] = 0;
		if (p->seen[i])
			bridge(p, i, m, x, c);
	}
	free(column);
}

/* The k directions of largest scatter of m weighted rows, from the eigenvectors of their m x m inner products. lambda[k], out: sums
 * of squares along them. */
static void components(struct part *p, double *lambda, long m, const double *x, const double *w)
{
	int n = p->n, rows = (int)m, k = p->k, found = 0;
	if (!k)
		return;
	double *y = mem_array((size_t)m * (size_t)n + 1, sizeof *y), *A = mem_array((size_t)(m * m) + 1, sizeof *A);
	double *d = mem_new((size_t)m + 1, sizeof *d), *z = mem_new((size_t)(m * k) + 1, sizeof *z);
	lapack_int *support = mem_new(2 * (size_t)k + 2, sizeof *support);
	for (long r = 0; r < m; r++)
		for (int i = 0; i < n; i++)
			y[r * n + i] = sqrt(w[r]) * (x[r * n + i] - p->mean[i]);
	cblas_dsyrk(CblasRowMajor, CblasLower, CblasNoTrans, rows, n, 1, y, n, 0, A, rows);
	bool ok = !LAPACKE_dsyevr(LAPACK_ROW_MAJOR, 'V', 'I', 'L', rows, A, rows, 0, 0, rows - k + 1, rows, 0, &found, d, z,
	                               k, support);
	memset(p->V, 0, (size_t)(n * k) * sizeof *p->V);
	if (ok)
		cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, k, rows, 1, y, n, z, k, 0, p->V, k);
	for (int c = 0; c < k; c++) {
		lambda[c] = ok && d[c] > d[k - 1] * 1e-12 ? d[c] : 0;
		for (int i = 0; i < n; i++)
			p->V[i * k + c] = lambda[c] > 0 ? p->V[i * k + c] / sqrt(lambda[c]) : 0;
	}
	free(y);
	free(A);
	free(d);
	free(z);
	free(support);
}

/* A frame of high leverage pulls a component onto itself and then has no distance from it: its length inside the components is added
 * to its distance. */
static void add_leverage(struct part *p, double *d, const double *lambda, long m, const double *x, const double *w)
{
#pragma omp parallel for
	for (long r = 0; r < m; r++) {
		double leverage = 0, inside = 0;
		for (int c = 0; c < p->k; c++) {
			double s = 0;
			for (int i = 0; i < p->n; i++)
				s += p->V[i * p->k + c] * (x[r * p->n + i] - p->mean[i]);
			leverage += lambda[c] > 0 ? w[r] * s * s / lambda[c] : 0;
			inside += s * s;
		}
		double own = fmax(0, (leverage - 0.4) / 0.6);
		d[r] = sqrt(d[r] * d[r] + own * inside / p->n);
	}
}

static void weighted_mean(struct part *p, long m, const double *x, const double *w)
{
	double sum = 0;
	for (long r = 0; r < m; r++)
		sum += w[r];
	if (sum > 0)
		memset(p->mean, 0, (size_t)p->n * sizeof *p->mean);
	for (long r = 0; r < m && sum > 0; r++)
		for (int i = 0; i < p->n; i++)
			p->mean[i] += w[r] / sum * x[r * p->n + i];
}

/* Weights of spherical principal components (Locantore et al. 1999), where the iteration starts: every frame counts by its direction
 * alone, however far out it is. */
static void spherical(const struct part *p, double *w, long m, const double *x)
{
	for (long r = 0; r < m; r++) {
		double sum = 0;
		for (int i = 0; i < p->n; i++)
			sum += (x[r * p->n + i] - p->mean[i]) * (x[r * p->n + i] - p->mean[i]);
		w[r] = sum > 0 ? 1 / sum : 0;
	}
}

/* Variance of a frame along each component. spread > 0: w are spherical weights, which give proportions only; spread, the sum of
 * squares about the medians, gives the size. */
static void set_variance(struct part *p, const double *lambda, long m, const double *w, double spread)
{
	double weight = 0;
	for (long r = 0; r < m; r++)
		weight += spread > 0 ? (w[r] > 0) : w[r];
	for (int k = 0; k < PILOT_COMPONENTS; k++)
		p->variance[k] = k < p->k && weight > 0 ? lambda[k] / weight * (spread > 0 ? spread / weight : 1) : 0;
}

void part_pilot(struct part *p, long m, double *x, double *c, const struct train_conf *conf)
{
	double *lambda = mem_new(PILOT_COMPONENTS + 1, sizeof *lambda), *w = mem_new((size_t)m + 1, sizeof *w);
	double *d = mem_new((size_t)m + 1, sizeof *d), *share = mem_new((size_t)m + 1, sizeof *share);
	double *sorted = mem_new((size_t)m + 1, sizeof *sorted), *was = mem_array((size_t)m * (size_t)p->n + 1, sizeof *was);
	p->seen = mem_new((size_t)p->n + 1, sizeof *p->seen);
	p->mean = mem_new((size_t)p->n + 1, sizeof *p->mean);
	p->V = mem_new((size_t)p->n * PILOT_COMPONENTS + 1, sizeof *p->V);
	begin_pilot(p, m, x, c, conf);
	memcpy(was, x, (size_t)m * (size_t)p->n * sizeof *was);
	p->variance = mem_new(PILOT_COMPONENTS + 1, sizeof *p->variance);
	spherical(p, w, m, x);
	bool missing = !part_all_measured(p, (int)m, c);
	double spread = 0;  // sum of squares about the medians
	for (long r = 0; r < m; r++)
		spread += w[r] > 0 ? 1 / w[r] : 0;
	for (int step = 0; step < IRLS_STEPS; step++) {
		p->k = (int)fmin(fmin(PILOT_COMPONENTS, (double)m / 4), p->n);
		components(p, lambda, m, x, w);
		set_variance(p, lambda, m, w, step ? 0 : spread);
		for (long i = 0; i < m * p->n; i++)
			x[i] = c[i] > 0 ? was[i] : x[i];
		part_complete(p, m, x, c, d, share);
		add_leverage(p, d, lambda, m, x, w);
		int shown = 0;
		// a frame that shows nothing of the part lies on its fit
		for (long r = 0; r < m; r++)
			if (share[r] > 0)
				sorted[shown++] = d[r];
		p->usual = fmax(shown ? stats_median(shown, sorted) : 0, smallest_distance * sqrt(spread / (double)m / fmax(p->n, 1)));
		double change = 0;
		for (long r = 0; r < m; r++) {
			double to = part_weight(p, conf, d[r]) * (share[r] > 0);
			change = fmax(change, fabs(to - w[r]));
			w[r] = to;
		}
		weighted_mean(p, m, x, w);
		if (step && change < settled && !missing)
			break;
	}
	components(p, lambda, m, x, w);
	set_variance(p, lambda, m, w, 0);
	free(lambda);
	free(w);
	free(d);
	free(share);
	free(sorted);
	free(was);
}
