/* How much each octave of relief varies: the photograph's contrast there, less noise's share and melanin's, over the shading's response. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "math/rng.h"
#include "tissue/relief/infer_impl.h"

/* map -= its mean about each place under the weights. */
static bool high_pass(float *map, struct infer_grid *g, double sigma, struct err *err)
{
	float *sum = g->scratch[0], *all = g->scratch[1];
	for (long i = 0; i < infer_texels(g); i++)
		sum[i] = map[i] * g->weight[i];
	if (!cv_blur(sum, sum, g->n, g->n, 1, sigma, err) || !cv_blur(all, g->weight, g->n, g->n, 1, sigma, err))
		return false;
	for (long i = 0; i < infer_texels(g); i++)
		map[i] = g->weight[i] > 0 ? map[i] - sum[i] / fmaxf(all[i], 1e-4f) : 0;
	return true;
}

/* One octave of a map, under the weights; out: scratch or other. */
static bool octave(float *out, const float *map, struct infer_grid *g, int b, struct err *err)
{
	float *sum = g->scratch[0], *all = g->scratch[1];
	for (int k = 0; k < 2; k++) {
		for (long i = 0; i < infer_texels(g); i++)
			sum[i] = map[i] * g->weight[i];
		if (!cv_blur(sum, sum, g->n, g->n, 1, g->sigma[b + k], err) || !cv_blur(all, g->weight, g->n, g->n, 1, g->sigma[b + k], err))
			return false;
		for (long i = 0; i < infer_texels(g); i++)
			out[i] = (k ? out[i] : 0) + (k ? -1 : 1) * sum[i] / fmaxf(all[i], 1e-3f);
	}
	return true;
}

double infer_square(const struct infer_grid *g, const float *map)
{
	double sum = 0, all = 0;
	for (long i = 0; i < infer_texels(g); i++) {
		sum += (double)g->weight[i] * (double)map[i] * (double)map[i];
		all += (double)g->weight[i];
	}
	return sum / fmax(all, 1e-9);
}

double infer_of_noise(const struct infer_grid *g, int b)
{
	double p = g->sigma[b] * g->sigma[b], q = g->sigma[b + 1] * g->sigma[b + 1];
	return (1 / p + 1 / q - 4 / (p + q)) / (4 * M_PI);
}

/* Process b has the spectrum of (G_b - G_b+1), of variance 1: what octave a of it varies by. */
static double shared(const struct infer_grid *g, int a, int b)
{
	double sum = 0;
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			for (int k = 0; k < 2; k++) {
				double s = pow(g->sigma[a + i], 2) + pow(g->sigma[a + j], 2) + pow(g->sigma[b + k], 2);
				sum += ((i + j + k) % 2 ? -1 : 1) / (2 * M_PI * s);
			}
	return sum / (1 / (2 * M_PI * pow(g->sigma[b], 2)) - 1 / (2 * M_PI * pow(g->sigma[b + 1], 2)));
}

/* Local variance of white noise, from the contrast of the finest octave (mean size, which few edges hardly change). Into out; its mean. */
static bool noise(float *out, double *mean, const float *map, struct infer_grid *g, struct err *err)
{
	const double over = 0.5, least = 0.003, of_white = infer_of_noise(g, 0);
	float *fine = g->scratch[2], *all = g->scratch[1];
	if (!octave(fine, map, g, 0, err))
		return false;
	for (long i = 0; i < infer_texels(g); i++)
		fine[i] = g->weight[i] * fabsf(fine[i]);
	if (!cv_blur(fine, fine, g->n, g->n, 1, over * g->scale, err) || !cv_blur(all, g->weight, g->n, g->n, 1, over * g->scale, err))
		return false;
	double sum = 0, weight = 0;
	for (long i = 0; i < infer_texels(g); i++) {
		double size = (double)(fine[i] / fmaxf(all[i], 1e-3f));
		out[i] = (float)fmax(M_PI / 2 * size * size / of_white, least * least);
		sum += (double)(g->weight[i] * out[i]);
		weight += (double)g->weight[i];
	}
	*mean = sum / fmax(weight, 1e-9);
	return true;
}

/* Shading's response in octave b: noise through that octave and the operator. */
static bool respond(double *out, struct infer_grid *g, int b, struct err *err)
{
	float *probe = mem_array((size_t)infer_texels(g), sizeof *probe), *lit = mem_array((size_t)infer_texels(g), sizeof *lit);
	struct rng rng = { 7 + (uint64_t)b };
	for (long i = 0; i < infer_texels(g); i++)
		probe[i] = (float)rng_normal(&rng);
	bool ok = octave(lit, probe, g, b, err);
	memcpy(probe, lit, (size_t)infer_texels(g) * sizeof *probe);
	shading_apply(g->scratch[3], probe, &g->shading);
	ok = ok && octave(lit, g->scratch[3], g, b, err) && octave(g->scratch[2], probe, g, b, err);
	*out = ok ? sqrt(infer_square(g, lit) / fmax(infer_square(g, g->scratch[2]), 1e-12)) : 0;
	free(probe);
	free(lit);
	return ok;
}

/* Non-negative p, at most `most`, of sum_b mix[a][b] p[b] = of[a], by coordinates. */
static void unmix(double p[B], const double mix[B][B], const double of[B], double most)
{
	for (int b = 0; b < B; b++)
		p[b] = 0;
	for (int sweep = 0; sweep < 200; sweep++)
		for (int b = 0; b < B; b++) {
			double up = 0, down = 0;
			for (int a = 0; a < B; a++) {
				double rest = of[a], w = 1 / (mix[a][a] * mix[a][a]);
				for (int k = 0; k < B; k++)
					rest -= k == b ? 0 : mix[a][k] * p[k];
				up += w * mix[a][b] * rest;
				down += w * mix[a][b] * mix[a][b];
			}
			p[b] = fmin(fmax(up / fmax(down, 1e-12), 0), most);
		}
}

struct infer_colour infer_colour_of(const double white[3], const double x[PIGMENT_N], const struct pigment_conf *pigment, const struct relief_conf *relief,
                               const struct relief_table *here)
{
	const double step = 0.1;
	double more[PIGMENT_N];
	struct relief_table there;
	memcpy(more, x, sizeof more);
	more[PIGMENT_ABL_MELANIN] += step;
	relief_table_make(&there, relief->low, relief->high, white, more, pigment);
	float f;
	int k = relief_place(here, logf(0.45f), &f), up = k + 20 < RELIEF_TABLE ? k + 20 : RELIEF_TABLE - 1;
	double tint = log((double)here->rgb[k][0] / (double)here->rgb[k][2]);
	double thicker = log((double)here->rgb[up][0] / (double)here->rgb[up][2]) - tint, brighter = log((double)here->light[up] / (double)here->light[k]);
	return (struct infer_colour){ (log((double)there.rgb[k][0] / (double)there.rgb[k][2]) - tint) / step,
		                log((double)there.light[k] / (double)here->light[k]) / step, thicker / (fabs(brighter) > 1e-6 ? brighter : 1e-6) };
}

/* A texel's precision: of noise, and of light at an edge, which spreads by `edge` (ln). Weights from now on are what is left of the noise's. */
static void weigh(struct infer_grid *g, const float *variance, const float *edge)
{
	for (long i = 0; i < infer_texels(g); i++) {
		double misplaced = g->conf->edge * (double)edge[i];
		g->precise[i] = g->weight[i] / (variance[i] + (float)(misplaced * misplaced));
		g->weight[i] = g->precise[i] * variance[i];
	}
}

/* How much each octave of relief varies, and what it is worth. */
static bool vary(struct infer_fit *fit, struct infer_grid *g, const struct infer_colour *colour, struct err *err)
{
	double mix[B][B], of[B], p[B], tint_noise, *of_melanin = fit->other;
	float *part = g->scratch[3];
	if (!noise(g->scratch[3], &tint_noise, g->tint, g, err))
		return false;
	for (int b = 0; b < B; b++) {
		if (!respond(&fit->response[b], g, b, err) || !octave(part, g->tint, g, b, err))
			return false;
		double tint = infer_square(g, part) - tint_noise * infer_of_noise(g, b);
		if (!octave(part, g->off, g, b, err))
			return false;
		double contrast = infer_square(g, part), seen = fmax(contrast - fit->noise * fit->noise * infer_of_noise(g, b), 0);
		double own = fmax(tint - pow(colour->tint_of_thickness, 2) * seen, 0);
		fit->contrast[b] = sqrt(contrast);
		of_melanin[b] = fmin(own * pow(colour->light / fmax(fabs(colour->tint), 1e-3), 2), seen);
		of[b] = seen - of_melanin[b];
	}
	for (int a = 0; a < B; a++)
		for (int b = 0; b < B; b++)
			mix[a][b] = shared(g, a, b) * pow(fit->response[b], 2);
	unmix(p, mix, of, g->conf->most * g->conf->most);
	for (int a = 0; a < B; a++) {
		double explained = 0, noisy = fit->noise * fit->noise * infer_of_noise(g, a);
		for (int b = 0; b < B; b++)
			explained += mix[a][b] * p[b];
		double other = of_melanin[a] + fmax(of[a] - explained, 0) + g->conf->light_error * g->conf->light_error;
		fit->other[a] = sqrt(other);
		fit->rms[a] = sqrt(p[a]);
		g->variance[a] = p[a] * noisy / (noisy + other);
	}
	return true;
}

bool infer_measure(struct infer_fit *fit, float *variance, struct infer_grid *g, const struct infer_colour *colour, const float *edge, struct err *err)
{
	double mean;
	if (!high_pass(g->off, g, g->sigma[B], err) || !high_pass(g->tint, g, g->sigma[B], err) || !noise(variance, &mean, g->off, g, err))
		return false;
	fit->noise = sqrt(mean);
	weigh(g, variance, edge);
	return vary(fit, g, colour, err);
}
