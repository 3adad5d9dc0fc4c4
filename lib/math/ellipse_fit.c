#include "math/ellipse_fit.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/stats.h"

enum { N = ELLIPSE_N, SAMPLES = 150, RANK_POINTS = 90 };
static const double TUKEY = 5.5;  // 97.5 % efficient on normal errors

/* Inverse of a symmetric positive definite matrix. Returns false when m is none. */
static bool invert(double inv[N][N], const double m[N][N])
{
	memcpy(inv, m, sizeof(double[N][N]));
	if (LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', N, &inv[0][0], N) || LAPACKE_dpotri(LAPACK_ROW_MAJOR, 'L', N, &inv[0][0], N))
		return false;
	for (int i = 0; i < N; i++)
		for (int j = i + 1; j < N; j++)
			inv[i][j] = inv[j][i];
	return true;
}

/* The eigenvector of m (3 x 3) with 4 k0 k2 - k1² > 0: the ellipse among the conics. */
static bool ellipse_vector(double k[3], double m[3][3])
{
	double re[3], im[3], v[3][3], unused;
	if (LAPACKE_dgeev(LAPACK_ROW_MAJOR, 'N', 'V', 3, &m[0][0], 3, re, im, &unused, 1, &v[0][0], 3))
		return false;
	double best = 0;
	for (int j = 0; j < 3; j++) {
		double cond = 4 * v[0][j] * v[2][j] - v[1][j] * v[1][j];
		if (im[j] == 0 && cond > best) {
			best = cond;
			for (int i = 0; i < 3; i++)
				k[i] = v[i][j];
		}
	}
	return best > 0;
}

/* Halir and Flusser: quadratic part S1, mixed S2, linear S3; the linear part is eliminated. */
static bool direct_conic(double k[6], const double s1[3][3], const double s2[3][3], const double s3[3][3])
{
	double inv[3][3], t[3][3], m[3][3];
	memcpy(inv, s3, sizeof inv);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			t[i][j] = -s2[j][i];
	if (LAPACKE_dposv(LAPACK_ROW_MAJOR, 'L', 3, 3, &inv[0][0], 3, &t[0][0], 3))
		return false;
	for (int j = 0; j < 3; j++) {
		double col[3];
		for (int i = 0; i < 3; i++) {
			col[i] = s1[i][j];
			for (int l = 0; l < 3; l++)
				col[i] += s2[i][l] * t[l][j];
		}
		m[0][j] = col[2] / 2;
		m[1][j] = -col[1];
		m[2][j] = col[0] / 2;
	}
	if (!ellipse_vector(k, m))
		return false;
	for (int i = 0; i < 3; i++)
		k[3 + i] = t[i][0] * k[0] + t[i][1] * k[1] + t[i][2] * k[2];
	return true;
}

bool ellipse_fit_direct(struct ellipse *e, int n, const double p[n][2], const double *weight)
{
	double mx = 0, my = 0, sum = 0, spread = 0;
	for (int i = 0; i < n; i++) {
		double w = weight ? weight[i] : 1;
		mx += w * p[i][0];
		my += w * p[i][1];
		sum += w;
	}
	if (n < N || !(sum > 0))
		return false;
	mx /= sum;
	my /= sum;
	for (int i = 0; i < n; i++)
		spread += (weight ? weight[i] : 1) * (fabs(p[i][0] - mx) + fabs(p[i][1] - my));
	double scale = spread / sum;
	if (!(scale > 0))
		return false;
	double s[6][6] = { 0 };
	for (int i = 0; i < n; i++) {
		double x = (p[i][0] - mx) / scale, y = (p[i][1] - my) / scale, w = weight ? weight[i] : 1;
		double row[6] = { x * x, x * y, y * y, x, y, 1 };
		for (int a = 0; a < 6; a++)
			for (int b = a; b < 6; b++)
				s[a][b] += w * row[a] * row[b];
	}
	double s1[3][3], s2[3][3], s3[3][3], k[6];
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++) {
			s1[a][b] = s[a < b ? a : b][a < b ? b : a];
			s2[a][b] = s[a][3 + b];
			s3[a][b] = s[3 + (a < b ? a : b)][3 + (a < b ? b : a)];
		}
	if (!direct_conic(k, s1, s2, s3) || !ellipse_from_conic(e, k))
		return false;
	e->cx = mx + scale * e->cx;
	e->cy = my + scale * e->cy;
	e->a *= scale;
	e->b *= scale;
	return true;
}

/* The best of SAMPLES five-point ellipses by the 55 % quantile of |distance|, akin to least median of squares: it tolerates
 * nearly half of the points as outliers. */
static bool sample_start(struct ellipse *best, int n, const double p[n][2])
{
	struct rng rng = { 0x11b5 };
	double *d = mem_array((size_t)n, sizeof *d), best_score = INFINITY;
	const int stride = (n + RANK_POINTS - 1) / RANK_POINTS;
	for (int s = 0; s < SAMPLES; s++) {
		double five[N][2];
		struct ellipse e;
		for (int i = 0; i < N; i++)
			memcpy(five[i], p[rng_below(&rng, n)], sizeof five[i]);
		if (!ellipse_fit_direct(&e, N, five, 0) || e.b < 0.2 * e.a)
			continue;
		int ranked = 0;
		for (int i = s % stride; i < n; i += stride) {
			/* distance along the ray from the centre: cheap, exact enough to rank */
			double x = p[i][0] - e.cx, y = p[i][1] - e.cy, c = cos(e.angle), s2 = sin(e.angle);
			double u = (c * x + s2 * y) / e.a, v = (c * y - s2 * x) / e.b, rho = hypot(u, v);
			d[ranked++] = rho > 1e-9 ? fabs(hypot(x, y) * (1 - 1 / rho)) : e.b;
		}
		double score = stats_quantile(ranked, d, 0.55);
		if (score < best_score) {
			best_score = score;
			*best = e;
		}
	}
	free(d);
	return best_score < INFINITY;
}

struct pass {
	double h[N][N], g[N];
	double weight;
};

/* One weighted Gauss-Newton system around e, from distances and angles. */
static void build(struct pass *pass, const struct ellipse *e, int n, const double *d, const double *t, const double *prior,
                  double *out, double scale)
{
	*pass = (struct pass){ 0 };
	for (int i = 0; i < n; i++) {
		double row[N];
		double k = prior ? sqrt(prior[i]) : 1, z = d[i] * k / (TUKEY * scale);
		double w = fabs(z) < 1 ? (1 - z * z) * (1 - z * z) : 0;
		if (out)
			out[i] = w;
		if (w == 0)
			continue;
		ellipse_normal_shift(row, e, t[i]);
		pass->weight += w;
		for (int a = 0; a < N; a++) {
			pass->g[a] += w * k * k * row[a] * d[i];
			for (int b = 0; b < N; b++)
				pass->h[a][b] += w * k * k * row[a] * row[b];
		}
	}
}

/* Median absolute deviation, repeated on the points within four times of it, since outliers widen the first. */
static double scale_of(int n, const double *d, const double *prior, double *work)
{
	double scale = INFINITY;
	for (int pass = 0; pass < 3; pass++) {
		int m = 0;
		for (int i = 0; i < n; i++) {
			double z = fabs(d[i]) * (prior ? sqrt(prior[i]) : 1);
			if (z < 4 * scale)
				work[m++] = z;
		}
		scale = m > N ? stats_mad(m, work, 0) : scale;
	}
	return scale;
}

/* The prior in units of the points' scale. */
static void add_known(struct pass *pass, const double q[N], const struct ellipse_prior *known, double scale)
{
	for (int a = 0; a < N; a++) {
		const double precision = known->alike * scale * scale / (known->sigma[a] * known->sigma[a]);
		pass->h[a][a] += precision;
		pass->g[a] += precision * (known->q[a] - q[a]);
	}
}

/* From the inverse M of the points' information H and that of the prior, A P, in units of their variance s²: s² M H M = s² (M - M A P M), and A² s² M P M. */
static void covariance(struct ellipse_fit *fit, const struct ellipse_prior *known, double scale)
{
	double (*m)[N] = fit->cov_q;
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++)
			for (int k = 0; k < N && known; k++)
				fit->known_q[a][b] += m[a][k] * m[k][b] * pow(known->alike * scale * scale / known->sigma[k], 2);
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++)
			m[a][b] = m[a][b] * scale * scale - (known ? fit->known_q[a][b] / known->alike : 0);
}

static bool fit_from(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2], const double *prior, double *out, double sigma,
                     bool have_start, const struct ellipse_prior *known)
{
	*fit = (struct ellipse_fit){ 0 };
	double *d = mem_array(3 * (size_t)n, sizeof *d), *work = d + n, *t = work + n, q[N], step[N];
	bool ok = true;
	ellipse_distances(n, d, t, e, p);
	/* Around a start from a sample, inliers may be many sigma off: the scale begins large and falls to the known noise with
	 * the fit. */
	const bool falls = sigma <= 0 || !have_start || known;
	const double least = sigma > 0 ? sigma : 1e-9;
	double scale = falls ? fmax(scale_of(n, d, prior, work), least) : sigma;
	if (!isfinite(scale)) {  // five points fit exactly: their noise cannot be estimated
		ok = sigma > 0;
		scale = sigma;
	}
	struct pass pass = { 0 };
	for (fit->iterations = 0; ok && fit->iterations < 60; fit->iterations++) {
		if (fit->iterations)  // at the start they are known
			ellipse_distances(n, d, t, e, p);
		build(&pass, e, n, d, t, prior, out, scale);
		double inv[N][N];
		ellipse_to_q(q, e);
		if (known)
			add_known(&pass, q, known, scale);
		if ((!known && pass.weight < N) || !invert(inv, pass.h)) {
			ok = false;
			break;
		}
		double size = 0;
		for (int a = 0; a < N; a++) {
			step[a] = 0;
			for (int b = 0; b < N; b++)
				step[a] += inv[a][b] * pass.g[b];
			q[a] += step[a];
			size = fmax(size, fabs(step[a]));
		}
		if (!ellipse_from_q(e, q)) {
			ok = false;
			break;
		}
		/* The scale may only fall: one that grew again would readmit outliers. */
		if (falls)
			scale = fmax(fmin(scale, scale_of(n, d, prior, work)), least);
		if (size >= 1e-4 * scale)
			continue;
		if (sigma <= 0 || known || scale <= least)
			break;
		scale = fmax(scale / 2, least);
	}
	if (ok) {
		ellipse_distances(n, d, t, e, p);
		build(&pass, e, n, d, t, prior, out, scale);
		fit->sigma = scale;
		fit->inliers = pass.weight / n;
		ellipse_to_q(q, e);
		if (known)
			add_known(&pass, q, known, scale);
		ok = invert(fit->cov_q, pass.h);
		covariance(fit, known, scale);
	}
	free(d);
	return ok;
}

bool ellipse_fit_robust(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2],
                        const double *prior, double *out, double sigma, bool have_start)
{
	return n >= N && (have_start || sample_start(e, n, p)) && fit_from(e, fit, n, p, prior, out, sigma, have_start, 0);
}

bool ellipse_fit_near(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2], const double *weight, double *out,
                      double sigma, const struct ellipse_prior *known)
{
	return fit_from(e, fit, n, p, weight, out, sigma, true, known);
}
