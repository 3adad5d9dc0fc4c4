#include "math/rbf.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "math/rng.h"

enum { ROUNDS = 10 };

static double distance2(int q, const double *a, const double *b)
{
	double sum = 0;
	for (int c = 0; c < q; c++)
		sum += (a[c] - b[c]) * (a[c] - b[c]);
	return sum;
}

/* k-means++ (Arthur and Vassilvitskii 2007): draws each next centre with probability proportional to the squared distance from
 * the nearest one so far. */
static void seed_centers(struct rbf *rbf, long n, const double *x, const double *w, struct rng *rng)
{
	double *near = mem_array((size_t)n + 1, sizeof *near);
	for (long i = 0; i < n; i++)
		near[i] = DBL_MAX;
	for (int k = 0; k < rbf->n; k++) {
		double sum = 0, at, below = 0;
		for (long i = 0; i < n; i++)
			sum += w[i] * (k ? near[i] : 1);
		at = rng_uniform(rng) * sum;
		long pick = 0;
		for (long i = 0; i < n && below <= at; i++) {
			double p = w[i] * (k ? near[i] : 1);
			below += p;
			pick = p > 0 ? i : pick;
		}
		memcpy(rbf->center + k * rbf->q, x + pick * rbf->q, (size_t)rbf->q * sizeof *x);
		for (long i = 0; i < n; i++)
			near[i] = fmin(near[i], distance2(rbf->q, x + i * rbf->q, rbf->center + k * rbf->q));
	}
	free(near);
}

/* One iteration of Lloyd's algorithm: moves every centre to the mean of the rows nearest to it. */
static void move_centers(struct rbf *rbf, long n, const double *x, const double *w)
{
	int q = rbf->q;
	double *sum = mem_new((size_t)(rbf->n * (q + 1)) + 1, sizeof *sum);
	for (long i = 0; i < n; i++) {
		int best = 0;
		double least = DBL_MAX;
		for (int k = 0; k < rbf->n && w[i] > 0; k++) {
			double d = distance2(q, x + i * q, rbf->center + k * q);
			best = d < least ? k : best;
			least = fmin(d, least);
		}
		for (int c = 0; c < q && w[i] > 0; c++)
			sum[best * (q + 1) + c] += w[i] * x[i * q + c];
		sum[best * (q + 1) + q] += w[i];
	}
	for (int k = 0; k < rbf->n; k++)
		for (int c = 0; c < q && sum[k * (q + 1) + q] > 0; c++)
			rbf->center[k * q + c] = sum[k * (q + 1) + c] / sum[k * (q + 1) + q];
	free(sum);
}

static double spacing(const struct rbf *rbf)
{
	double sum = 0;
	for (int a = 0; a < rbf->n; a++) {
		double least = DBL_MAX;
		for (int b = 0; b < rbf->n; b++)
			if (b != a)
				least = fmin(least, distance2(rbf->q, rbf->center + a * rbf->q, rbf->center + b * rbf->q));
		sum += rbf->n > 1 ? sqrt(least) : 1;
	}
	return sum > 0 ? sum / rbf->n : 1;
}

static double *activations(const struct rbf *rbf, long n, const double *x)
{
	double *phi = mem_array((size_t)n * (size_t)rbf->n + 1, sizeof *phi);
	for (long i = 0; i < n; i++)
		for (int k = 0; k < rbf->n; k++)
			phi[i * rbf->n + k]
			        = exp(-distance2(rbf->q, x + i * rbf->q, rbf->center + k * rbf->q) / (2 * rbf->width * rbf->width));
	return phi;
}

void rbf_centers(struct rbf *rbf, int functions, long n, int q, const double *x, const double *w, uint64_t seed)
{
	struct rng rng = { seed };
	*rbf = (struct rbf){ .q = q, .n = functions < n ? functions : (int)n };
	rbf->center = mem_new((size_t)(rbf->n * q) + 1, sizeof *rbf->center);
	seed_centers(rbf, n, x, w, &rng);
	for (int i = 0; i < ROUNDS; i++)
		move_centers(rbf, n, x, w);
}

void rbf_train(struct rbf *rbf, double width, double ridge, long n, int r, const double *x, const double *y,
               const double *w)
{
	int k = rbf->n;
	rbf->r = r;
	rbf->weight = mem_grow(rbf->weight, (size_t)(k * r) + 1, sizeof *rbf->weight);
	rbf->constant = mem_grow(rbf->constant, (size_t)r + 1, sizeof *rbf->constant);
	rbf->width = width * spacing(rbf);
	double *phi = activations(rbf, n, x), *Gxx = mem_new((size_t)(k * k) + 1, sizeof *Gxx);
	double *Gxy = mem_new((size_t)(k * r) + 1, sizeof *Gxy), *mean = mem_new((size_t)k + 1, sizeof *mean);
	double weight = regress_moments(Gxx, Gxy, mean, rbf->constant, n, k, r, phi, y, w);
	regress(rbf->weight, k, r, Gxx, Gxy, weight, mean, ridge);
	for (int o = 0; o < r; o++)
		for (int f = 0; f < k; f++)
			rbf->constant[o] -= rbf->weight[o * k + f] * mean[f];
	free(phi);
	free(Gxx);
	free(Gxy);
	free(mean);
}

void rbf_predict(double *y, const struct rbf *rbf, long n, const double *x)
{
	double *phi = activations(rbf, n, x);
	for (long i = 0; i < n; i++)
		for (int o = 0; o < rbf->r; o++) {
			double sum = rbf->constant[o];
			for (int k = 0; k < rbf->n; k++)
				sum += rbf->weight[o * rbf->n + k] * phi[i * rbf->n + k];
			y[i * rbf->r + o] = sum;
		}
	free(phi);
}

void rbf_free(struct rbf *rbf)
{
	free(rbf->center);
	free(rbf->weight);
	free(rbf->constant);
	*rbf = (struct rbf){ 0 };
}
