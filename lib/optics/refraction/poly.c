#include "optics/refraction/poly.h"

#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/simd.h"
#include "math/vec.h"
#include "optics/lightpath/path.h"

/* The start is the ray from P in direction w + (gamma P_x, gamma P_y, -beta): w bent towards the axis by beta and towards P by
 * gamma. The eye is invariant to rotations about its axis and to reflection, so gamma and beta are polynomials in the invariants
 * |P_xy|², P_xy·w_xy and w_z, scaled to about -1..1. They are smooth across the horizon and at the centre; the ray meets the
 * surface wherever P lies, so that relief needs no fourth variable. */

int refraction_monomials(int degree)
{
	return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

/* Monomials in the order of their degree: 1, a b d, aa ab ad bb bd dd, aaa aab aad abb abd add bbb bbd bdd ddd. */
SIMD_INLINE float polynomial(const float *restrict c, int degree, float a, float b, float d)
{
	if (degree == 1)
		return (c[0] + a * c[1]) + (b * c[2] + d * c[3]);
	if (degree == 2)
		return (c[0] + a * ((c[1] + a * c[4]) + (b * c[5] + d * c[6]))) + (b * ((c[2] + b * c[7]) + d * c[8]) + d * (c[3] + d * c[9]));
	float aa = (c[4] + a * c[10]) + (b * c[11] + d * c[12]), ab = (c[5] + b * c[13]) + d * c[14], ad = c[6] + d * c[15];
	float bb = (c[7] + b * c[16]) + d * c[17], bd = c[8] + d * c[18], dd = c[9] + d * c[19];
	return (c[0] + a * ((c[1] + a * aa) + (b * ab + d * ad))) + (b * ((c[2] + b * bb) + d * bd) + d * (c[3] + d * dd));
}

/* Problems and starts, structure of arrays. */
struct starts {
	const float *px, *py, *wx, *wy, *wz;
	float *qx, *qy, *qz;
};

SIMD_INLINE void bend(const struct starts *s, int n, const struct refraction *f, int degree)
{
	enum { MOST = (REFRACTION_MAX_DEGREE + 1) * (REFRACTION_MAX_DEGREE + 2) * (REFRACTION_MAX_DEGREE + 3) / 6 };
	float gamma[MOST], beta[MOST];
	const float inv = 1 / (float)f->radius;
	const float *px = s->px, *py = s->py, *wx = s->wx, *wy = s->wy, *wz = s->wz;
	float *qx = s->qx, *qy = s->qy, *qz = s->qz;
	for (int i = 0; i < refraction_monomials(degree); i++) {
		gamma[i] = f->data[i][0];
		beta[i] = f->data[i][1];
	}
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float u = inv * px[i], v = inv * py[i], a = 2 * (u * u + v * v) - 1, b = u * wx[i] + v * wy[i], d = 2 * wz[i] + 1;
		float g = polynomial(gamma, degree, a, b, d);
		qx[i] = wx[i] + g * u;
		qy[i] = wy[i] + g * v;
		qz[i] = wz[i] - polynomial(beta, degree, a, b, d);
	}
}

SIMD_CLONES static void bend_1(const struct starts *s, int n, const struct refraction *f)
{
	bend(s, n, f, 1);
}

SIMD_CLONES static void bend_2(const struct starts *s, int n, const struct refraction *f)
{
	bend(s, n, f, 2);
}

SIMD_CLONES static void bend_3(const struct starts *s, int n, const struct refraction *f)
{
	bend(s, n, f, 3);
}

void refraction_start(const struct refraction *f, int n, const float *px, const float *py, const float *wx, const float *wy,
                      const float *wz, float *qx, float *qy, float *qz)
{
	_Static_assert(REFRACTION_MAX_DEGREE == 3, "one function for each degree");
	static void (*const of_degree[])(const struct starts *, int, const struct refraction *) = { bend_1, bend_2, bend_3 };
	of_degree[f->degree - 1](&(struct starts){ px, py, wx, wy, wz, qx, qy, qz }, n, f);
}

/* One sample's three equations (K - P) × q = 0, linear in the coefficients. weight: of the sample. */
static void equations(double *rows, double *rhs, int n, const struct refraction *f, const double P[3], const double w[3],
                      const double K[3], double weight)
{
	double u = P[0] / f->radius, t = P[1] / f->radius, a = 2 * (u * u + t * t) - 1, b = u * w[0] + t * w[1], d = 2 * w[2] + 1;
	double m[20] = { 1, a, b, d, a * a, a * b, a * d, b * b, b * d, d * d }, v[3];
	for (int i = 4, at = 10; i < 10; i++)  // each of degree 2 times the variables from its own last one on
		for (int k = i < 6 ? i - 4 : i < 7 ? 2 : i < 8 ? 1 : 2; k < 3; k++)
			if (i != 5 || k > 0)
				m[at++] = m[i] * m[1 + k];
	vec_add(v, K, -1, P);
	vec_unit(v, v);
	const double across[3][3] = { { 0, v[2], -v[1] }, { -v[2], 0, v[0] }, { v[1], -v[0], 0 } };
	for (int r = 0; r < 3; r++) {
		rhs[r] = -weight * vec_dot(across[r], w);
		for (int i = 0; i < n; i++) {
			rows[(long)r * 2 * n + i] = weight * m[i] * (across[r][0] * u + across[r][1] * t);
			rows[(long)r * 2 * n + n + i] = -weight * m[i] * across[r][2];
		}
	}
}

bool refraction_fit(struct refraction *f)
{
	enum { RADII = 14, THETAS = 16, PHIS = 16, ALL = 3 * RADII * THETAS * PHIS };
	int n = refraction_monomials(f->degree), m = 0;
	double *rows = mem_new((size_t)ALL * 2 * (size_t)n, sizeof *rows), *rhs = mem_new(ALL, sizeof *rhs);
	for (int s = 0; s < RADII * THETAS * PHIS; s++) {
		// Chebyshev's points: denser towards the ends, where a polynomial fit is worst.
		double r = f->radius * sin(M_PI / 2 * (s % RADII + 0.5) / RADII);
		double c = 0.5 * (REFRACTION_BEHIND - 1) + 0.5 * (REFRACTION_BEHIND + 1) * cos(M_PI * (s / RADII % THETAS + 0.5) / THETAS);
		double phi = M_PI * (s / RADII / THETAS + 0.5) / PHIS, q = sqrt(1 - c * c);
		double P[3] = { r, 0, f->depth }, w[3] = { q * cos(phi), q * sin(phi), c }, K[3];
		enum lightpath_status status = path_shortest(K, &(struct path){ &f->cornea, P, 0, w });
		if (status != LIGHTPATH_OK && status != LIGHTPATH_BEYOND_RIM)
			continue;
		equations(rows + (long)m * 2 * n, rhs + m, n, f, P, w, K, status == LIGHTPATH_OK ? 1 : 0.1);
		m += 3;
	}
	// On one thread, so that the bits do not depend on the number of threads.
	int threads = openblas_get_num_threads();
	openblas_set_num_threads(1);
	bool ok = m > 6 * n && !LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', m, 2 * n, 1, rows, 2 * n, rhs, 1);
	openblas_set_num_threads(threads);
	free(f->data);
	f->n_data = n;
	f->data = mem_new((size_t)n, sizeof *f->data);
	for (int i = 0; i < n; i++) {
		f->data[i][0] = (float)rhs[i];
		f->data[i][1] = (float)rhs[n + i];
	}
	free(rows);
	free(rhs);
	return ok;
}
