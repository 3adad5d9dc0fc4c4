#include <lapacke.h>
#include <math.h>
#include <string.h>

#include "bridge/nls.h"
#include "eye/pigment.h"

const char *const pigment_names[PIGMENT_N] = {
	"abl.melanin", "abl.eumelanin_ratio", "stroma.melanin", "stroma.eumelanin_ratio", "stroma.thickness_scale",
	"exposure", "white.red", "white.blue", "veil",
};

static const double lower[PIGMENT_N] = { -11.5, 0, -11.5, 0, -4.6, -3, -0.7, -0.7, 0 };
static const double upper[PIGMENT_N] = { -0.1, 1, -0.1, 1, 1.6, 3, 0.7, 0.7, 0.2 };

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

void pigment_model(double rgb[3], const double x[PIGMENT_N], const struct tissue_optics *optics, double stroma,
                   const struct pigment_conf *c)
{
	tissue_reflectance(rgb, optics, stroma, c->cos_view, c->cos_light);
	double gain[3] = { exp(x[PIGMENT_RED]), 1, exp(x[PIGMENT_BLUE]) };
	for (int k = 0; k < 3; k++)
		rgb[k] = optics->exposure * gain[k] * rgb[k] + x[PIGMENT_VEIL];
}

static double noise(const struct pigment_class *class, int k, const struct pigment_conf *c)
{
	double model = c->model_error * class->rgb[k], sampling = class->spread[k] / sqrt(class->texels);
	return sqrt(model * model + sampling * sampling + c->floor * c->floor);
}

/* Classes, then priors. */
static bool residuals(void *ctx, const double *x, double *r, double *J)
{
	const struct problem *p = ctx;
	(void)J;
	struct tissue tissue = pigment_tissue(x, p->conf);
	struct tissue_optics optics;
	tissue_optics_make(&optics, &tissue, &p->bands);
	for (int i = 0; i < p->classes->n; i++) {
		const struct pigment_class *class = &p->classes->of[i];
		double rgb[3];
		pigment_model(rgb, x, &optics, class->thickness, p->conf);
		for (int k = 0; k < 3; k++)
			*r++ = (rgb[k] - class->rgb[k]) / noise(class, k, p->conf);
	}
	for (int j = 0; j < PIGMENT_N; j++)
		*r++ = (x[j] - p->conf->prior[j][0]) / p->conf->prior[j][1];
	return true;
}

/* Halton's sequence, base 2, 3, 5 ...: starts that fill the priors evenly. The first is the priors' middle. */
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

/* Same place: within a tenth of a sigma in every unknown. */
static bool same(const double a[PIGMENT_N], const double b[PIGMENT_N], const double sigma[PIGMENT_N])
{
	for (int j = 0; j < PIGMENT_N; j++)
		if (fabs(a[j] - b[j]) > 0.1 * sigma[j])
			return false;
	return true;
}

static void count_minima(struct pigment_fit *fit, int n, double x[][PIGMENT_N], const double cost[])
{
	fit->minima = 1;
	for (int s = 0; s < n; s++) {
		bool known = !(cost[s] < fit->cost + 2) || same(x[s], fit->x, fit->sigma);
		for (int m = 0; m < fit->minima - 1 && !known; m++)
			known = same(x[s], fit->other[m], fit->sigma);
		if (known || fit->minima > PIGMENT_MINIMA_MAX)
			continue;
		memcpy(fit->other[fit->minima - 1], x[s], sizeof x[s]);
		fit->other[fit->minima++ - 1][PIGMENT_N] = cost[s];
	}
}

static void measure(struct pigment_fit *fit, const struct problem *p, double cov[PIGMENT_N][PIGMENT_N])
{
	double relative = 0;
	for (int i = 0; i < PIGMENT_N; i++) {
		fit->sigma[i] = sqrt(fmax(cov[i][i], 0));
		for (int j = 0; j < PIGMENT_N; j++)
			fit->correlation[i][j] = i == j ? 1 : cov[i][j] / sqrt(cov[i][i] * cov[j][j]);
	}
	struct tissue tissue = pigment_tissue(fit->x, p->conf);
	struct tissue_optics optics;
	tissue_optics_make(&optics, &tissue, &p->bands);
	for (int i = 0; i < p->classes->n; i++) {
		const struct pigment_class *class = &p->classes->of[i];
		double rgb[3], light = 0.2126 * class->rgb[0] + 0.7152 * class->rgb[1] + 0.0722 * class->rgb[2];
		pigment_model(rgb, fit->x, &optics, class->thickness, p->conf);
		for (int k = 0; k < 3; k++) {
			double d = rgb[k] - class->rgb[k];
			fit->residual_rgb[k] += d * d / p->classes->n;
			relative += d * d / (light * light) / (3 * p->classes->n);
		}
	}
	for (int k = 0; k < 3; k++)
		fit->residual_rgb[k] = sqrt(fit->residual_rgb[k]);
	fit->residual = sqrt(relative);
}

/* Information of the classes alone, in units of the priors: eigenvectors below 1 are told by the priors, not by the
 * photograph. */
static bool information(struct pigment_fit *fit, struct problem *p, struct err *err)
{
	enum { N = PIGMENT_N };
	int m = 3 * p->classes->n;
	double r[2][3 * PIGMENT_CLASSES_MAX + N], J[3 * PIGMENT_CLASSES_MAX][N], a[N * N] = { 0 }, w[N];
	for (int j = 0; j < N; j++) {
		double x[N], h = 1e-4 * p->conf->prior[j][1];
		memcpy(x, fit->x, sizeof x);
		for (int side = 0; side < 2; side++) {
			x[j] = fit->x[j] + (side ? h : -h);
			residuals(p, x, r[side], 0);
		}
		for (int i = 0; i < m; i++)
			J[i][j] = (r[1][i] - r[0][i]) / 2e-4;
	}
	for (int i = 0; i < m; i++)
		for (int j = 0; j < N; j++)
			for (int k = 0; k < N; k++)
				a[j * N + k] += J[i][j] * J[i][k];
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

bool pigment_solve(struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                   struct err *err)
{
	*fit = (struct pigment_fit) { .cost = INFINITY, .starts = conf->starts < STARTS_MAX ? conf->starts : STARTS_MAX };
	struct problem problem = { classes, conf, { 0 } };
	tissue_bands_make(&problem.bands, conf->bands, conf->illuminant);
	int m = 3 * classes->n + PIGMENT_N;
	const struct nls_conf nls = { .max_iter = 200, .ftol = 1e-10, .numeric = true };
	double x[STARTS_MAX][PIGMENT_N], cost[STARTS_MAX], cov[PIGMENT_N][PIGMENT_N], best_cov[PIGMENT_N][PIGMENT_N];
	for (int s = 0; s < fit->starts; s++) {
		struct nls_result result;
		start_at(x[s], s, conf);
		if (!nls_solve(&result, PIGMENT_N, x[s], lower, upper, m, residuals, &problem, &nls, &cov[0][0], err))
			return false;
		cost[s] = result.cost;
		fit->iterations += result.iterations;
		if (result.cost < fit->cost) {
			fit->cost = result.cost;
			memcpy(fit->x, x[s], sizeof x[s]);
			memcpy(best_cov, cov, sizeof cov);
		}
	}
	measure(fit, &problem, best_cov);
	count_minima(fit, fit->starts, x, cost);
	return information(fit, &problem, err);
}
