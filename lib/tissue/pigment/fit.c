#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/nls.h"
#include "tissue/pigment/pigment.h"

const char *const pigment_names[PIGMENT_N] = {
	"abl.melanin", "abl.eumelanin_ratio", "stroma.melanin", "stroma.eumelanin_ratio", "stroma.thickness_scale",
	"exposure", "white.red", "white.blue", "veil",
};

static const double lower[PIGMENT_N] = { -11.5, 0, -11.5, 0, -4.6, -3, -0.7, -0.7, 0 };
static const double upper[PIGMENT_N] = { -0.5, 1, -0.5, 1, 1.6, 3, 0.7, 0.7, 0.2 };

enum { RESIDUALS_MAX = 3 * PIGMENT_CLASSES_MAX + PIGMENT_N };

struct problem {
	const struct pigment_classes *classes;
	const struct pigment_conf *conf;
	struct tissue_bands bands;
};

struct tissue pigment_tissue(const double x[PIGMENT_N], const struct pigment_conf *c)
{
	return (struct tissue) {
		.layer = { { exp(x[PIGMENT_ABL_MELANIN]), x[PIGMENT_ABL_RATIO] }, { exp(x[PIGMENT_STROMA_MELANIN]), x[PIGMENT_STROMA_RATIO] } },
		.abl_thickness = c->abl_thickness,
		.thickness_scale = exp(x[PIGMENT_SCALE]),
		.exposure = exp(x[PIGMENT_EXPOSURE]),
		.multiple = c->multiple,
		.illuminant = c->illuminant,
	};
}

/* What a photograph shows of a reflectance: exposure, error of the white, veil. */
static void photograph(double seen[3], const double rgb[3], const double x[PIGMENT_N])
{
	double gain[3] = { exp(x[PIGMENT_RED]), 1, exp(x[PIGMENT_BLUE]) };
	for (int k = 0; k < 3; k++)
		seen[k] = exp(x[PIGMENT_EXPOSURE]) * gain[k] * rgb[k] + x[PIGMENT_VEIL];
}

void pigment_model(double rgb[3], const double x[PIGMENT_N], const struct tissue_optics *optics, double stroma,
                   const struct pigment_conf *c)
{
	double bare[3];
	tissue_reflectance(bare, optics, stroma, c->cos_view, c->cos_light);
	photograph(rgb, bare, x);
}

/* Relative error of a channel from noise alone; the model's own errors are added where residuals are formed. */
static double noise(const struct pigment_class *class, int k, const struct pigment_conf *c)
{
	double sampling = class->spread[k] / sqrt(class->texels);
	return sqrt(sampling * sampling + c->floor * c->floor) / fmax(class->rgb[k], c->floor);
}

/* Three residuals of a class, in logarithms: its luminance (green), which shadows change as well, and two chromatic ratios, which they
 * do not change. */
static void class_residuals(double r[3], const struct pigment_class *class, const double rgb[3], const struct pigment_conf *c)
{
	double floor = fmax(c->floor / 4, 1e-6), d[3], s[3];
	for (int k = 0; k < 3; k++) {
		d[k] = log(fmax(rgb[k], floor) / fmax(class->rgb[k], floor));
		s[k] = noise(class, k, c);
	}
	r[0] = d[1] / hypot(c->light_error, s[1]);
	r[1] = (d[0] - d[1]) / hypot(c->model_error, s[0]);
	r[2] = (d[2] - d[1]) / hypot(c->model_error, s[2]);
}

/* Reflectance of the tissue alone in every class: the expensive part. */
static void reflect(double rgb[][3], const struct problem *p, const double *x)
{
	struct tissue tissue = pigment_tissue(x, p->conf);
	struct tissue_optics optics;
	tissue_optics_make(&optics, &tissue, &p->bands);
	for (int i = 0; i < p->classes->n; i++)
		tissue_reflectance(rgb[i], &optics, p->classes->of[i].thickness, p->conf->cos_view, p->conf->cos_light);
}

/* Classes, then priors. */
static void compare(double r[], const struct problem *p, const double *x, double rgb[][3])
{
	for (int i = 0; i < p->classes->n; i++, r += 3) {
		double seen[3];
		photograph(seen, rgb[i], x);
		class_residuals(r, &p->classes->of[i], seen, p->conf);
	}
	for (int j = 0; j < PIGMENT_N; j++)
		*r++ = (x[j] - p->conf->prior[j][0]) / p->conf->prior[j][1];
}

/* Central differences; the unknowns that are not the tissue's reuse its reflectance. */
static bool residuals(void *ctx, const double *x, double *r, double *J)
{
	enum { N = PIGMENT_N };
	const double h = 1e-5;  // unknowns are of order 1: truncation and rounding are both about 1e-10
	const struct problem *p = ctx;
	double here[PIGMENT_CLASSES_MAX][3], there[PIGMENT_CLASSES_MAX][3], side[2][RESIDUALS_MAX], at[N];
	reflect(here, p, x);
	compare(r, p, x, here);
	memcpy(at, x, sizeof at);
	for (int j = 0; J && j < N; j++) {
		for (int s = 0; s < 2; s++) {
			at[j] = x[j] + (s ? h : -h);
			if (j <= PIGMENT_SCALE)
				reflect(there, p, at);
			compare(side[s], p, at, j <= PIGMENT_SCALE ? there : here);
		}
		at[j] = x[j];
		for (int i = 0; i < 3 * p->classes->n + N; i++)
			J[i * N + j] = (side[1][i] - side[0][i]) / (2 * h);
	}
	return true;
}

/* Halton's sequence, base 2, 3, 5 ...: starts that fill the priors evenly, to two sigma. The first is the priors' means. */
static void start_at(double x[PIGMENT_N], int start, const struct pigment_conf *c)
{
	static const int base[PIGMENT_N] = { 2, 3, 5, 7, 11, 13, 17, 19, 23 };
	for (int j = 0; j < PIGMENT_N; j++) {
		double u = 0, f = 1;
		for (int i = start; i > 0; i /= base[j]) {
			f /= base[j];
			u += f * (i % base[j]);
		}
		double at = c->prior[j][0] + (start ? (2 * u - 1) * 2 : 0) * c->prior[j][1];
		x[j] = fmin(fmax(at, lower[j] + 1e-3), upper[j] - 1e-3);
	}
}

static void measure(struct pigment_fit *fit, const struct problem *p, double cov[PIGMENT_N][PIGMENT_N])
{
	for (int i = 0; i < PIGMENT_N; i++) {
		fit->sigma[i] = sqrt(fmax(cov[i][i], 0));
		for (int j = 0; j < PIGMENT_N; j++)
			fit->correlation[i][j] = i == j ? 1 : cov[i][j] / sqrt(cov[i][i] * cov[j][j]);
	}
	struct tissue tissue = pigment_tissue(fit->x, p->conf);
	struct tissue_optics optics;
	tissue_optics_make(&optics, &tissue, &p->bands);
	double square = 0, light = 0, colour = 0;
	for (int i = 0; i < p->classes->n; i++) {
		const struct pigment_class *class = &p->classes->of[i];
		double rgb[3], r[3];
		pigment_model(rgb, fit->x, &optics, class->thickness, p->conf);
		for (int k = 0; k < 3; k++) {
			double d = rgb[k] - class->rgb[k];
			fit->residual_rgb[k] += d * d / p->classes->n;
			square += d * d;
			light += class->rgb[k] * class->rgb[k];
			r[k] = log(fmax(rgb[k], 1e-4) / fmax(class->rgb[k], 1e-4));
		}
		colour += (pow(r[0] - r[1], 2) + pow(r[2] - r[1], 2)) / (2 * p->classes->n);
	}
	fit->residual = sqrt(square / light);
	fit->residual_colour = sqrt(colour);
	for (int k = 0; k < 3; k++)
		fit->residual_rgb[k] = sqrt(fit->residual_rgb[k]);
}

/* Fisher information of the classes alone, in units of the priors' sigma: along eigenvectors of eigenvalue below 1 the priors determine
 * the result, not the photograph. */
static bool information(struct pigment_fit *fit, struct problem *p, struct err *err)
{
	enum { N = PIGMENT_N };
	double r[RESIDUALS_MAX], J[RESIDUALS_MAX * N], a[N * N] = { 0 }, w[N];
	residuals(p, fit->x, r, J);
	for (int i = 0; i < 3 * p->classes->n; i++)
		for (int j = 0; j < N; j++)
			for (int k = 0; k < N; k++)
				a[j * N + k] += J[i * N + j] * p->conf->prior[j][1] * J[i * N + k] * p->conf->prior[k][1];
	if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', N, a, N, w))
		return err_set(err, "pigment: the information matrix has no eigenvectors");
	for (int d = 0; d < N && w[d] < 1; d++) {
		fit->information[fit->directions] = fmax(w[d], 0);
		for (int j = 0; j < N; j++)
			fit->direction[fit->directions][j] = a[j * N + d];
		fit->directions++;
	}
	return true;
}

enum { STARTS_MAX = 64 };

/* Result of one start. */
struct outcome {
	bool ok;
	double x[PIGMENT_N], cov[PIGMENT_N][PIGMENT_N];
	struct nls_result result;
	struct err err;
};

/* Solves from every start; results are compared in order, so that threads change nothing. False: all failed. */
static bool run_starts(struct outcome out[], int n, const struct problem *problem, const double *from)
{
	// A cost that falls by less than a hundred-thousandth moves no unknown by a hundredth of its sigma.
	const struct nls_conf nls = { .max_iter = 100, .ftol = 1e-5 };
	int m = 3 * problem->classes->n + PIGMENT_N;
#pragma omp parallel for schedule(dynamic) if (n > 1)
	for (int s = 0; s < n; s++) {
		struct problem own = *problem;
		out[s].err.msg[0] = 0;
		start_at(out[s].x, s, problem->conf);
		if (from)
			memcpy(out[s].x, from, sizeof out[s].x);
		out[s].ok = nls_solve(&out[s].result, PIGMENT_N, out[s].x, lower, upper, m, residuals, &own, &nls, &out[s].cov[0][0], &out[s].err);
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
		memcpy(fit->other[fit->minima - 1], x, sizeof out[s].x);
		fit->other[fit->minima++ - 1][PIGMENT_N] = cost;
	}
}

bool pigment_solve(struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                   const double *from, struct err *err)
{
	*fit = (struct pigment_fit) { .cost = INFINITY, .starts = from ? 1 : conf->starts < STARTS_MAX ? conf->starts : STARTS_MAX };
	struct problem problem = { classes, conf, { 0 } };
	struct outcome *out = mem_new((size_t)fit->starts, sizeof *out), *best = out;
	tissue_bands_make(&problem.bands, conf->bands, conf->illuminant);
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
		measure(fit, &problem, best->cov);
		count_minima(fit, fit->starts, out);
	}
	free(out);
	return ok && information(fit, &problem, err);
}
