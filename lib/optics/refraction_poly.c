#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/simd.h"
#include "optics/lightpath_path.h"
#include "optics/refraction_parts.h"

/* The eye is the same after a turn about its axis and in a mirror: K_xy = A P_xy + B w_xy with A and B functions of
 * what such a turn leaves alone: |P_xy|², P_xy·w_xy, w_z. Smooth across the horizon and at the centre. */

int refraction_monomials(int degree)
{
	return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

enum { LANES = 64 };

/* Sum of c[i][j][k] a^i b^j d^k over i + j + k <= degree by Horner's rule, c in the order of the loops; A and B at once. */
SIMD_CLONES static void horner(float A[LANES], float B[LANES], int degree, const float (*c)[3], const float a[LANES],
                               const float b[LANES], const float d[LANES])
{
	float ta[LANES], tb[LANES], ua[LANES], ub[LANES];
	int at = refraction_monomials(degree);
	for (int n = 0; n < LANES; n++)
		A[n] = B[n] = 0;
	for (int i = degree; i >= 0; i--) {
		for (int n = 0; n < LANES; n++)
			ta[n] = tb[n] = 0;
		for (int j = degree - i; j >= 0; j--) {
			for (int n = 0; n < LANES; n++)
				ua[n] = ub[n] = 0;
			for (int k = degree - i - j; k >= 0; k--) {
				at--;
				SIMD_LOOP
				for (int n = 0; n < LANES; n++) {
					ua[n] = ua[n] * d[n] + c[at][0];
					ub[n] = ub[n] * d[n] + c[at][1];
				}
			}
			SIMD_LOOP
			for (int n = 0; n < LANES; n++) {
				ta[n] = ta[n] * b[n] + ua[n];
				tb[n] = tb[n] * b[n] + ub[n];
			}
		}
		SIMD_LOOP
		for (int n = 0; n < LANES; n++) {
			A[n] = A[n] * a[n] + ta[n];
			B[n] = B[n] * a[n] + tb[n];
		}
	}
}

void refraction_start(const struct refraction *f, int n, const float *px, const float *py, const float *wx, const float *wy,
                      const float *wz, float *x, float *y)
{
	const float inv = 1 / f->radius;
	for (int from = 0; from < n; from += LANES) {
		float a[LANES] = { 0 }, b[LANES] = { 0 }, d[LANES] = { 0 }, A[LANES], B[LANES];
		int m = n - from < LANES ? n - from : LANES;
		for (int i = 0; i < m; i++) {
			float u = px[from + i], v = py[from + i];
			a[i] = 2 * inv * inv * (u * u + v * v) - 1;
			b[i] = inv * (u * wx[from + i] + v * wy[from + i]);
			d[i] = 2 * wz[from + i] + 1;
		}
		horner(A, B, f->degree, (const float(*)[3])f->data, a, b, d);
		for (int i = 0; i < m; i++) {
			x[from + i] = A[i] * px[from + i] + B[i] * wx[from + i];
			y[from + i] = A[i] * py[from + i] + B[i] * wy[from + i];
		}
	}
}

/* One sample's two equations: rows of the design matrix for x and y of the chart. */
static void equations(double *rows, double *rhs, int n, const struct refraction *f, const double P[3], const double w[3],
                      const double K[3])
{
	double a = 2 * (P[0] * P[0] + P[1] * P[1]) / (f->radius * f->radius) - 1, d = 2 * w[2] + 1;
	double b = (P[0] * w[0] + P[1] * w[1]) / f->radius, t = 2 * f->cornea.R - f->cornea.p * K[2];
	int at = 0;
	for (int i = 0; i <= f->degree; i++)
		for (int j = 0; i + j <= f->degree; j++)
			for (int k = 0; i + j + k <= f->degree; k++, at++) {
				double m = pow(a, i) * pow(b, j) * pow(d, k);
				for (int xy = 0; xy < 2; xy++) {
					rows[xy * 2 * n + at] = m * P[xy];
					rows[xy * 2 * n + n + at] = m * w[xy];
				}
			}
	rhs[0] = K[0] / t;
	rhs[1] = K[1] / t;
}

bool refraction_fit(struct refraction *f)
{
	enum { RADII = 14, THETAS = 16, PHIS = 16 };
	int n = refraction_monomials(f->degree), m = 0;
	double *rows = mem_new((size_t)2 * RADII * THETAS * PHIS * 2 * n, sizeof *rows);
	double *rhs = mem_new((size_t)2 * RADII * THETAS * PHIS, sizeof *rhs);
	for (int s = 0; s < RADII * THETAS * PHIS; s++) {
		// Chebyshev's points: denser towards the ends, where a polynomial fit is worst.
		double r = f->radius * sin(M_PI / 2 * (s % RADII + 0.5) / RADII);
		double c = 0.5 * (REFRACTION_BEHIND - 1) + 0.5 * (REFRACTION_BEHIND + 1) * cos(M_PI * (s / RADII % THETAS + 0.5) / THETAS);
		double phi = M_PI * (s / RADII / THETAS + 0.5) / PHIS, q = sqrt(1 - c * c);
		double P[3] = { r, 0, f->depth }, w[3] = { q * cos(phi), q * sin(phi), c }, K[3];
		enum lightpath_status status = path_shortest(K, &(struct path){ &f->cornea, P, 0, w });
		if (status != LIGHTPATH_OK && status != LIGHTPATH_BEYOND_RIM)
			continue;
		equations(rows + (size_t)2 * m * 2 * n, rhs + 2 * m, n, f, P, w, K);
		m++;
	}
	// One thread: the same bits on every number of them.
	int threads = openblas_get_num_threads();
	openblas_set_num_threads(1);
	bool ok = m > 2 * n && !LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', 2 * m, 2 * n, 1, rows, 2 * n, rhs, 1);
	openblas_set_num_threads(threads);
	free(f->data);
	f->n_data = n;
	f->data = mem_new(n, sizeof *f->data);
	for (int i = 0; i < n; i++) {
		f->data[i][0] = rhs[i];
		f->data[i][1] = rhs[n + i];
	}
	free(rows);
	free(rhs);
	return ok;
}
