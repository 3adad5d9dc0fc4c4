#include "math/regress.h"

#include <cblas.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static const double smallest_eigenvalue = 1e-10;

/* Standard deviation of each input; 0 where it is constant up to rounding. */
static void scales(double *sd, int q, const double *Gxx, double weight, const double *mean)
{
	for (int i = 0; i < q; i++) {
		double s = weight > 0 ? sqrt(fmax(Gxx[i * q + i], 0) / weight) : 0;
		sd[i] = s > 64 * DBL_EPSILON * (mean ? fabs(mean[i]) : 0) ? s : 0;
	}
}

int regress(double *b, int q, int r, const double *Gxx, const double *Gxy, double weight, const double *mean,
            double ridge)
{
	double *sd = mem_new((size_t)q + 1, sizeof *sd), *C = mem_new((size_t)(q * q) + 1, sizeof *C);
	double *d = mem_new((size_t)q + 1, sizeof *d), *t = mem_new((size_t)(q * r) + 1, sizeof *t);
	double *z = mem_new((size_t)(q * r) + 1, sizeof *z);
	int rank = 0;
	scales(sd, q, Gxx, weight, mean);
	for (int i = 0; i < q; i++) {
		for (int j = 0; j < q; j++)
			C[i * q + j] = sd[i] > 0 && sd[j] > 0 ? Gxx[i * q + j] / weight / sd[i] / sd[j] : 0;
		for (int c = 0; c < r; c++)
			z[i * r + c] = sd[i] > 0 ? Gxy[i * r + c] / weight / sd[i] : 0;
	}
	memset(b, 0, (size_t)(q * r) * sizeof *b);
	if (q && !LAPACKE_dsyevd(LAPACK_ROW_MAJOR, 'V', 'L', q, C, q, d)) {
		// t = V^T z / (d + ridge); b = V t, scaled back.
		cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, q, r, q, 1, C, q, z, r, 0, t, r);
		for (int i = 0; i < q; i++) {
			bool kept = d[i] > smallest_eigenvalue * d[q - 1] && d[i] > 0;
			rank += kept;
			for (int c = 0; c < r; c++)
				t[i * r + c] = kept ? t[i * r + c] / (d[i] + ridge) : 0;
		}
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, q, r, q, 1, C, q, t, r, 0, z, r);
		for (int i = 0; i < q; i++)
			for (int c = 0; c < r; c++)
				b[c * q + i] = sd[i] > 0 ? z[i * r + c] / sd[i] : 0;
	}
	free(sd);
	free(C);
	free(d);
	free(t);
	free(z);
	return rank;
}

void regress_reach(double *reach, int q, const double *Gxx, double weight, const double *mean, const double *least)
{
	double *sd = mem_new((size_t)q + 1, sizeof *sd), *C = mem_new((size_t)(q * q) + 1, sizeof *C);
	double *d = mem_new((size_t)q + 1, sizeof *d), *unit = mem_new((size_t)q + 1, sizeof *unit);
	bool ok = weight > 0;
	scales(sd, q, Gxx, weight, mean);
	for (int i = 0; i < q; i++) {
		sd[i] = isinf(least[i]) || sd[i] > least[i] ? sd[i] : 0;
		unit[i] = sd[i] > 0 ? sd[i] : least[i] / sqrt(weight);
	}
	for (int i = 0; i < q; i++)
		for (int j = 0; j < q; j++) {
			C[i * q + j] = sd[i] > 0 && sd[j] > 0 ? Gxx[i * q + j] / weight / sd[i] / sd[j] : i == j;
			ok = ok && isfinite(C[i * q + j]);
		}
	ok = ok && q && !LAPACKE_dsyevd(LAPACK_ROW_MAJOR, 'V', 'L', q, C, q, d);
	for (int i = 0; i < q; i++) {
		double *row = reach + (size_t)i * (size_t)(q + 1), spread = sqrt(weight * fmax(d[i], smallest_eigenvalue * d[q - 1]));
		row[q] = ok ? 0 : NAN;
		for (int j = 0; j < q; j++) {
			row[j] = ok ? C[j * q + i] / spread / unit[j] : NAN;
			row[q] -= row[j] != 0 ? row[j] * mean[j] : 0;
		}
	}
	free(sd);
	free(C);
	free(d);
	free(unit);
}

double regress_leverage(const double *reach, int q, const double *x)
{
	double h = 0;
	for (int i = 0; i < q; i++) {
		const double *row = reach + (size_t)i * (size_t)(q + 1);
		double sum = row[q];
		for (int j = 0; j < q; j++)
			sum += row[j] != 0 ? row[j] * x[j] : 0;
		h += sum * sum;
	}
	return h;
}

static void weighted_mean(double *mean, long n, int q, const double *x, const double *w, double weight)
{
	memset(mean, 0, (size_t)q * sizeof *mean);
	for (long i = 0; i < n; i++)
		for (int c = 0; c < q && w[i] > 0; c++)
			mean[c] += w[i] / weight * x[i * q + c];
}

static double *centred(long n, int q, const double *x, const double *w, const double *mean)
{
	double *out = mem_array((size_t)n * (size_t)q + 1, sizeof *out);
	for (long i = 0; i < n; i++)
		for (int c = 0; c < q; c++)
			out[i * q + c] = w[i] > 0 ? sqrt(w[i]) * (x[i * q + c] - mean[c]) : 0;
	return out;
}

double regress_moments(double *Gxx, double *Gxy, double *mx, double *my, long n, int q, int r, const double *x,
                       const double *y, const double *w)
{
	double weight = 0;
	for (long i = 0; i < n; i++)
		weight += w[i];
	weighted_mean(mx, n, q, x, w, weight);
	weighted_mean(my, n, r, y, w, weight);
	double *cx = centred(n, q, x, w, mx), *cy = centred(n, r, y, w, my);
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, q, q, (int)n, 1, cx, q, cx, q, 0, Gxx, q);
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, q, r, (int)n, 1, cx, q, cy, r, 0, Gxy, r);
	free(cx);
	free(cy);
	return weight;
}
