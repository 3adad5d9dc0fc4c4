/* pigment: five irises from blue to brown, their reflectance by Monte Carlo (all orders of scattering); what each search makes
 * of it. The paper searches by hand: its interface's five sliders are stood in for by a grid. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/nls.h"
#include "tissue/pigment/pigment.h"
#include "tests/peers/reflectance_full.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/photon.h"

enum { EYES = 5, DEPTHS = 5, N = PIGMENT_N };
static const double melanin[EYES] = { 0.003, 0.01, 0.03, 0.1, 0.3 };
static const double scale = 0.3, g = 0.8;  // scattering is not as forward as the fit has it

struct search {
	const struct pigment_classes *eyes;
	struct pigment_conf conf;
	bool grid, full;
	int steps, first, last;  // irises
	double x[EYES][N], residual[EYES];
};

static struct pigment_conf conf_of(bool multiple, int bands, int starts)
{
	return (struct pigment_conf) {
		.prior = { { log(0.02), 1.5 }, { 0.7, 0.15 }, { log(0.01), 1.5 }, { 0.7, 0.15 }, { log(0.3), 0.7 },
		           { multiple ? 0 : log(2.2), multiple ? 0.25 : 0.5 }, { 0, 0.05 }, { 0, 0.05 }, { 0, 0.01 } },
		.abl_thickness = 0.04, .cos_light = 0.84, .cos_view = 1, .light_error = 0.05, .model_error = 0.05, .floor = 0.001,
		.bands = bands, .starts = starts, .multiple = multiple,
	};
}

static void photons(struct pigment_classes *out, double abl, long n)
{
	struct tissue_bands bands;
	tissue_bands_make(&bands, 4, ILLUMINANT_D65);
	out->n = DEPTHS;
	for (int i = 0; i < DEPTHS; i++) {
		struct pigment_class *c = &out->of[i];
		*c = (struct pigment_class) { .thickness = 0.25 + 0.1 * i, .share = 0.5, .texels = 1e4 };
		for (int k = 0; k < bands.n; k++) {
			float stroma = (float)c->thickness, r;
			double s = tissue_scattering(bands.nm[k]);
			const struct tissue_layer layer[] = { { abl, 0.7 }, { abl / 4, 0.7 } };
			struct photon_slab slab = { 1, 1, &stroma, 0.04, { s / (1 - g), scale * s / (1 - g) },
				                        { tissue_absorption(&layer[0], bands.nm[k]), scale * tissue_absorption(&layer[1], bands.nm[k]) }, g, false };
			photon_reflectance(&r, &slab, 0.84, n, 0, (uint64_t)(k + 1));
			for (int j = 0; j < 3; j++)
				c->rgb[j] += bands.rgb[k][j] * r;
		}
	}
}

/* Root mean square over classes and channels, relative to theirs. */
static double misfit(const double model[][3], const struct pigment_classes *eye)
{
	double square = 0, all = 0;
	for (int i = 0; i < eye->n; i++)
		for (int k = 0; k < 3; k++) {
			square += pow(model[i][k] - eye->of[i].rgb[k], 2);
			all += pow(eye->of[i].rgb[k], 2);
		}
	return sqrt(square / all);
}

/* Sliders: two concentrations, two ratios, the thickness; the exposure is turned up until the picture is as bright. */
static void grid_search(struct search *s, int e)
{
	const struct pigment_classes *eye = &s->eyes[e];
	struct tissue_bands bands;
	tissue_bands_make(&bands, s->conf.bands, s->conf.illuminant);
	s->residual[e] = INFINITY;
	int n = s->steps, total = n * n * n * 9;
	for (int g = 0; g < total; g++) {
		double x[N] = { 0 }, model[DEPTHS][3], top = 0, bottom = 0;
		x[PIGMENT_ABL_MELANIN] = log(1e-3) + log(500) * (g % n) / (n - 1);
		x[PIGMENT_STROMA_MELANIN] = log(1e-3) + log(500) * (g / n % n) / (n - 1);
		x[PIGMENT_SCALE] = log(0.05) + log(30) * (g / n / n % n) / (n - 1);
		x[PIGMENT_ABL_RATIO] = 0.3 + 0.3 * (g / n / n / n % 3);
		x[PIGMENT_STROMA_RATIO] = 0.3 + 0.3 * (g / n / n / n / 3);
		struct tissue tissue = pigment_tissue(x, &s->conf);
		struct tissue_optics optics;
		tissue_optics_make(&optics, &tissue, &bands);
		for (int i = 0; i < DEPTHS; i++) {
			tissue_reflectance(model[i], &optics, eye->of[i].thickness, s->conf.cos_view, s->conf.cos_light);
			for (int k = 0; k < 3; k++) {
				top += model[i][k] * eye->of[i].rgb[k];
				bottom += model[i][k] * model[i][k];
			}
		}
		for (int i = 0; i < DEPTHS; i++)
			for (int k = 0; k < 3; k++)
				model[i][k] *= top / bottom;
		double r = misfit(model, eye);
		if (r < s->residual[e]) {
			s->residual[e] = r;
			memcpy(s->x[e], x, sizeof x);
		}
	}
}

static void search(void *ctx)
{
	struct search *s = ctx;
	for (int e = s->first; e < s->last; e++) {
		struct pigment_fit fit;
		struct err err = { 0 };
		if (s->grid) {
			grid_search(s, e);
		} else if (pigment_solve(&fit, &s->eyes[e], &s->conf, 0, &err)) {
			memcpy(s->x[e], fit.x, sizeof fit.x);
			s->residual[e] = fit.residual;
		}
	}
}

/* Every wavelength, exact for the order asked for. */
static bool full_residuals(void *ctx, const double *x, double *r, double *J)
{
	const struct search *s = ctx;
	struct tissue tissue = pigment_tissue(x, &s->conf);
	struct observer observer;
	(void)J;
	observer_make(&observer, s->conf.illuminant);
	for (int i = 0; i < s->eyes->n; i++) {
		double rgb[3], seen[3];
		tissue_reflectance_full(rgb, &tissue, &observer, s->eyes->of[i].thickness, s->conf.cos_view, s->conf.cos_light);
		double gain[3] = { exp(x[PIGMENT_RED]), 1, exp(x[PIGMENT_BLUE]) };
		for (int k = 0; k < 3; k++)
			seen[k] = exp(x[PIGMENT_EXPOSURE]) * gain[k] * rgb[k] + x[PIGMENT_VEIL];
		for (int k = 0; k < 3; k++)
			*r++ = log(seen[k] / s->eyes->of[i].rgb[k]) / s->conf.model_error;
	}
	for (int j = 0; j < N; j++)
		*r++ = (x[j] - s->conf.prior[j][0]) / s->conf.prior[j][1];
	return true;
}

static void search_full(void *ctx)
{
	static const double lo[N] = { -11.5, 0, -11.5, 0, -4.6, -3, -0.7, -0.7, 0 }, hi[N] = { -0.5, 1, -0.5, 1, 1.6, 3, 0.7, 0.7, 0.2 };
	const struct nls_conf nls = { .max_iter = 40, .ftol = 1e-6, .numeric = true };
	struct search *s = ctx;
	for (int e = s->first; e < s->last; e++) {
		struct search one = { .eyes = &s->eyes[e], .conf = s->conf };
		struct nls_result result;
		struct err err = { 0 };
		double r[3 * DEPTHS + N], model[DEPTHS][3];
		for (int j = 0; j < N; j++)
			s->x[e][j] = fmax(s->conf.prior[j][0], lo[j] + 1e-3);
		if (!nls_solve(&result, N, s->x[e], lo, hi, 3 * DEPTHS + N, full_residuals, &one, &nls, 0, &err))
			continue;
		full_residuals(&one, s->x[e], r, 0);
		for (int i = 0; i < DEPTHS; i++)
			for (int k = 0; k < 3; k++)
				model[i][k] = s->eyes[e].of[i].rgb[k] * exp(r[3 * i + k] * s->conf.model_error);
		s->residual[e] = misfit(model, &s->eyes[e]);
	}
}

static double report(const char *method, const char *setting, struct search *s, int reps)
{
	struct bench_time t = bench_time(s->full ? search_full : search, s, reps);
	double residual = 0, factor = 0, thick = 0;
	int n = s->last - s->first;
	t.median /= n;
	t.low /= n;
	t.high /= n;
	for (int e = s->first; e < s->last; e++) {
		residual += s->residual[e] / n;
		factor += fabs(s->x[e][PIGMENT_ABL_MELANIN] - log(melanin[e])) / n;
		thick += fabs(s->x[e][PIGMENT_SCALE] - log(scale)) / n;
	}
	bench_row("residual", method, setting, t, "iris", 100 * residual, "%", "reflectance, rms of classes, mean of irises");
	bench_row("melanin", method, setting, t, "iris", 100 * (exp(factor) - 1), "%", "border layer melanin, mean factor less 1");
	bench_row("scale", method, setting, t, "iris", 100 * (exp(thick) - 1), "%", "stroma scale, mean factor less 1");
	return 100 * (exp(factor) - 1);
}

int main(int argc, char **argv)
{
	bench_open("pigment", argc, argv);
	struct pigment_classes *eyes = mem_new(EYES, sizeof *eyes);
	for (int e = 0; e < EYES; e++)
		photons(&eyes[e], melanin[e], bench_quick() ? 10000 : 60000);
	int reps = bench_quick() ? 1 : 3;
	double paper = INFINITY, ours = INFINITY;
	for (int steps = 4; steps <= 10; steps += 3) {
		struct search s = { .eyes = eyes, .conf = conf_of(false, 3, 1), .grid = true, .steps = steps, .last = EYES };
		char setting[64];
		snprintf(setting, sizeof setting, "%d positions of each concentration slider", steps);
		paper = fmin(paper, report("sliders by grid, single scattering (paper)", setting, &s, reps));
	}
	static const struct { bool multiple; int bands, starts; } rows[] = {
		{ false, 4, 1 }, { true, 3, 1 }, { true, 4, 1 }, { true, 8, 1 }, { true, 4, 4 },
	};
	for (int i = 0; i < COUNT(rows); i++) {
		struct search s = { .eyes = eyes, .conf = conf_of(rows[i].multiple, rows[i].bands, rows[i].starts), .last = EYES };
		char setting[64];
		snprintf(setting, sizeof setting, "%d bands, %d start%s", rows[i].bands, rows[i].starts, rows[i].starts > 1 ? "s" : "");
		double got = report(rows[i].multiple ? "Ceres, all orders" : "Ceres, single scattering", setting, &s, rows[i].starts > 1 ? 1 : reps);
		if (rows[i].multiple && rows[i].bands == 4 && rows[i].starts == 4)
			ours = got;
	}
	for (int m = 0; m < 2 && !bench_quick(); m++) {
		struct search s = { .eyes = eyes, .conf = conf_of(m, 4, 1), .full = true, .first = 2, .last = 3 };
		report(m ? "Ceres, all orders" : "Ceres, single scattering", "81 wavelengths, 1 start, the middle iris", &s, 1);
	}
	bench_goal("melanin of the border layer from photons", "nearer than the paper's sliders", ours, "% off", ours < paper);
	free(eyes);
	return bench_close();
}
