#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/nls.h"
#include "tissue/pigment/problem.h"

enum { STARTS_MAX = 64 };

/* Result of one start. */
struct outcome {
	bool ok;
	double x[PROBLEM_N_MAX], cov[PROBLEM_N_MAX * PROBLEM_N_MAX];
	struct nls_result result;
	struct err err;
};

/* Halton's sequence, base 2, 3, 5 ...: starts that fill the priors evenly, to two sigma. The first is the priors' means. */
static void start_at(double x[], int start, const struct pigment_problem *p)
{
	static const int base[PIGMENT_N] = { 2, 3, 5, 7, 11, 13, 17, 19, 23 };
	for (int j = 0; j < p->n; j++) {
		double u = 0.5, f = 1;  // thicknesses begin at the profile
		if (j < PIGMENT_N)
			u = 0;
		for (int i = j < PIGMENT_N ? start : 0; i > 0; i /= base[j]) {
			f /= base[j];
			u += f * (i % base[j]);
		}
		double at = p->mean[j] + (start ? (2 * u - 1) * 2 : 0) * p->sigma[j];
		x[j] = fmin(fmax(at, p->lower[j] + 1e-3), p->upper[j] - 1e-3);
	}
}

/* Melanin of the rings against their mean, by the covariance of the unknowns. */
static void measure_rings(struct pigment_fit *fit, const struct pigment_problem *p, const struct outcome *best)
{
	const struct pigment_classes *classes = p->classes;
	int at = pigment_problem_rings_at(p), n = p->n, of_ring[PIGMENT_RINGS_MAX] = { 0 };
	fit->rings = classes->rings;
	for (int i = 0; i < classes->n && classes->rings; i++) {
		fit->ring[classes->of[i].ring].share += classes->of[i].share;
		of_ring[classes->of[i].ring]++;
	}
	for (int r = 0; r < fit->rings; r++) {
		struct pigment_ring *ring = &fit->ring[r];
		double variance = 0;
		for (int a = 0; at >= 0 && a < fit->rings; a++)
			for (int b = 0; b < fit->rings; b++)
				variance += ((a == r) - 1.0 / fit->rings) * ((b == r) - 1.0 / fit->rings) * best->cov[(at + a) * n + at + b];
		ring->share /= of_ring[r] ? of_ring[r] : 1;
		ring->beyond = pigment_problem_beyond(p, best->x, r);
		ring->melanin = pigment_problem_melanin(p, best->x, r);
		ring->sigma = sqrt(fmax(variance, 0));
	}
}

static void measure(struct pigment_fit *fit, const struct pigment_problem *p, const struct outcome *best)
{
	const double *cov = best->cov;
	int n = p->n;
	for (int i = 0; i < PIGMENT_N; i++) {
		fit->sigma[i] = sqrt(fmax(cov[i * n + i], 0));
		for (int j = 0; j < PIGMENT_N; j++)
			fit->correlation[i][j] = i == j ? 1 : cov[i * n + j] / sqrt(cov[i * n + i] * cov[j * n + j]);
	}
	for (int i = 0; i < p->classes->n; i++)
		fit->thickness[i] = pigment_problem_thickness(p, best->x, i);
	measure_rings(fit, p, best);
	double square = 0, light = 0, colour = 0, green = 0;
	for (int i = 0; i < p->classes->n; i++) {
		const struct pigment_class *class = &p->classes->of[i];
		double rgb[3], r[3];
		pigment_class_model(rgb, fit, p->classes, i, p->conf, &p->bands);
		for (int k = 0; k < 3; k++) {
			double d = rgb[k] - class->rgb[k];
			fit->residual_rgb[k] += d * d / p->classes->n;
			square += d * d;
			light += class->rgb[k] * class->rgb[k];
			r[k] = log(fmax(rgb[k], 1e-4) / fmax(class->rgb[k], 1e-4));
		}
		green += r[1] * r[1] / p->classes->n;
		colour += (pow(r[0] - r[1], 2) + pow(r[2] - r[1], 2)) / (2 * p->classes->n);
	}
	fit->residual = sqrt(square / light);
	fit->residual_colour = sqrt(colour);
	fit->residual_light = sqrt(green);
	fit->light_error = p->conf->light_error;
	fit->model_error = p->conf->model_error;
	for (int k = 0; k < 3; k++)
		fit->residual_rgb[k] = sqrt(fit->residual_rgb[k]);
}

/* Fisher information of the classes about the nine unknowns, the thicknesses marginalised (Schur complement), in units of the priors'
 * sigma: along eigenvectors of eigenvalue below 1 the priors determine the result, not the photograph. */
static bool information(struct pigment_fit *fit, struct pigment_problem *p, const double *x, struct err *err)
{
	enum { N = PIGMENT_N };
	double r[PROBLEM_M_MAX], J[PROBLEM_M_MAX * PROBLEM_N_MAX], a[PROBLEM_N_MAX][PROBLEM_N_MAX] = { 0 }, top[N * N], w[N];
	int n = p->n;
	pigment_residuals(p, x, r, J);
	for (int i = 0; i < 3 * p->classes->n; i++)
		for (int j = 0; j < n; j++)
			for (int k = 0; k < n; k++)
				a[j][k] += J[i * n + j] * p->sigma[j] * J[i * n + k] * p->sigma[k];
	for (int k = n - 1; k >= N; k--) {  // eliminated one by one, each with its prior
		a[k][k] += 1;
		for (int i = 0; i < k; i++)
			for (int j = 0; j < k; j++)
				a[i][j] -= a[i][k] * a[k][j] / a[k][k];
	}
	for (int i = 0; i < N * N; i++)
		top[i] = a[i / N][i % N];
	if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', N, top, N, w))
		return err_set(err, "pigment: the information matrix has no eigenvectors");
	for (int d = 0; d < N && w[d] < 1; d++) {
		fit->information[fit->directions] = fmax(w[d], 0);
		for (int j = 0; j < N; j++)
			fit->direction[fit->directions][j] = top[j * N + d];
		fit->directions++;
	}
	return true;
}

/* Solves from every start; results are compared in order, so that threads change nothing. False: all failed. */
static bool run_starts(struct outcome out[], int n, const struct pigment_problem *problem, const double *from)
{
	// A cost that falls by less than a hundred-thousandth moves no unknown by a hundredth of its sigma.
	const struct nls_conf nls = { .max_iter = 100, .ftol = 1e-5 };
#pragma omp parallel for schedule(dynamic) if (n > 1)
	for (int s = 0; s < n; s++) {
		struct pigment_problem own = *problem;
		out[s].err.msg[0] = 0;
		start_at(out[s].x, s, problem);
		if (from)
			memcpy(out[s].x, from, PIGMENT_N * sizeof *from);
		out[s].ok = nls_solve(&out[s].result, own.n, out[s].x, own.lower, own.upper, own.m, pigment_residuals, &own, &nls, out[s].cov, &out[s].err);
	}
	bool ok = false;
	for (int s = 0; s < n; s++)
		ok = ok || out[s].ok;
	return ok;
}

/* Same minimum: within a tenth of a sigma in every unknown. */
static bool same(const double a[PIGMENT_N], const double b[PIGMENT_N], const double sigma[PIGMENT_N])
{
	for (int j = 0; j < PIGMENT_N; j++)
		if (fabs(a[j] - b[j]) > 0.1 * sigma[j])
			return false;
	return true;
}

static void count_minima(struct pigment_fit *fit, int n, const struct outcome out[])
{
	fit->minima = 1;
	for (int s = 0; s < n; s++) {
		const double *x = out[s].x, cost = out[s].result.cost;
		bool known = !out[s].ok || !(cost < fit->cost + 2) || same(x, fit->x, fit->sigma);
		for (int m = 0; m < fit->minima - 1 && !known; m++)
			known = same(x, fit->other[m], fit->sigma);
		if (known || fit->minima > PIGMENT_MINIMA_MAX)
			continue;
		memcpy(fit->other[fit->minima - 1], x, PIGMENT_N * sizeof *x);
		fit->other[fit->minima++ - 1][PIGMENT_N] = cost;
	}
}

static bool solve_once(struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                       const double *from, struct err *err)
{
	*fit = (struct pigment_fit) { .cost = INFINITY, .starts = from ? 1 : conf->starts < STARTS_MAX ? conf->starts : STARTS_MAX };
	struct pigment_problem problem;
	struct outcome *out = mem_new((size_t)fit->starts, sizeof *out), *best = out;
	pigment_problem_make(&problem, classes, conf);
	bool ok = run_starts(out, fit->starts, &problem, from) || err_set(err, "pigment: %s", out->err.msg);
	for (int s = 0; ok && s < fit->starts; s++) {
		fit->iterations += out[s].result.iterations;
		if (out[s].ok && out[s].result.cost < fit->cost) {
			fit->cost = out[s].result.cost;
			best = &out[s];
		}
	}
	memcpy(fit->x, best->x, sizeof fit->x);
	if (ok) {
		measure(fit, &problem, best);
		count_minima(fit, fit->starts, out);
		ok = information(fit, &problem, best->x, err);
	}
	free(out);
	return ok;
}

/* From the priors' means alone, so that all starts are held to the same errors: those that this fit shows where conf's are smaller. */
static bool solve_errors(struct pigment_fit *fit, struct pigment_conf *used, const struct pigment_classes *classes, struct err *err)
{
	enum { SWEEPS = 3 };
	used->starts = 1;
	for (int k = 0; k < SWEEPS; k++) {
		if (!solve_once(fit, classes, used, 0, err))
			return false;
		if (fit->residual_light <= used->light_error && fit->residual_colour <= used->model_error)
			break;
		used->light_error = fmax(used->light_error, fit->residual_light);
		used->model_error = fmax(used->model_error, fit->residual_colour);
	}
	return true;
}

/* How much of the freedom that conf gives to melanin this iris has: the share of colour's residual under one melanin that is not the
 * model's own error. */
static bool varies(double *out, const struct pigment_classes *classes, const struct pigment_conf *conf, struct err *err)
{
	struct pigment_conf one = *conf;
	struct pigment_fit fit;
	one.melanin_ring = 0;
	one.starts = 1;
	*out = 0;
	if (!(conf->melanin_ring > 0) || !classes->rings)
		return true;
	if (!solve_once(&fit, classes, &one, 0, err))
		return false;
	*out = sqrt(fmax(1 - pow(conf->model_error / fmax(fit.residual_colour, 1e-9), 2), 0));
	return true;
}

/* Little melanin is told from above only: any less looks the same, and the likeliest amount is the largest that does. What is reported is the mean
 * of its logarithm, over the profile of the posterior (the others at their best for each amount), and its standard deviation there. Where melanin
 * is told from both sides, by less than `told` (ln), mode and mean are the same. */
static bool take_mean(struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf, struct err *err)
{
	enum { STEPS = 13, AT = 8, M = PIGMENT_ABL_MELANIN };
	const double told = 0.5, step = 0.5, *prior = conf->prior[M], mode = fit->x[M];
	struct pigment_conf fixed = *conf;
	struct pigment_fit at;
	double x[PIGMENT_N], all = 0, sum = 0, square = 0;
	if (!(fit->sigma[M] > told))
		return true;
	fixed.starts = 1;
	fixed.prior[M][1] = 1e-3;
	memcpy(x, fit->x, sizeof x);
	for (int k = 0; k <= STEPS; k++) {  // the last one at the mean
		double t = k < STEPS ? mode + (k - AT) * step : sum / all;
		fixed.prior[M][0] = x[M] = fmin(fmax(t, -11), -0.6);  // inside of the bounds
		if (!solve_once(&at, classes, &fixed, x, err))
			return false;
		double off = (t - prior[0]) / prior[1], weight = exp(fit->cost - at.cost - off * off / 2);
		all += k < STEPS ? weight : 0;
		sum += k < STEPS ? weight * t : 0;
		square += k < STEPS ? weight * (t - mode) * (t - mode) : 0;
	}
	double mean = sum / all, variance = fmax(square / all - (mean - mode) * (mean - mode), 1e-4);
	memcpy(fit->x, at.x, sizeof fit->x);
	memcpy(fit->residual_rgb, at.residual_rgb, sizeof fit->residual_rgb);
	memcpy(fit->thickness, at.thickness, sizeof fit->thickness);
	memcpy(fit->ring, at.ring, sizeof fit->ring);
	fit->residual = at.residual;
	fit->residual_colour = at.residual_colour;
	fit->residual_light = at.residual_light;
	fit->sigma[M] = sqrt(variance);
	return true;
}

bool pigment_solve(struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                   const double *from, struct err *err)
{
	struct pigment_conf used = *conf;
	double free_share;
	if (!varies(&free_share, classes, conf, err))
		return false;
	used.melanin_ring *= free_share;
	if (!solve_errors(fit, &used, classes, err))
		return false;
	used.starts = conf->starts;
	bool ok = solve_once(fit, classes, &used, from, err) && take_mean(fit, classes, &used, err);
	fit->varies = free_share;
	return ok;
}
