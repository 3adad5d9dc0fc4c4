#include "tissue/relief/relief.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "bridge/nls.h"
#include "tissue/relief/model.h"

enum { B = RELIEF_BANDS, MAP_MAX = 640 };

/* The fit's own, coarser maps; [size][size]. */
struct problem {
	int size;
	double scale;               // texels a mm
	const struct relief_conf *conf;
	struct relief_table table;
	float kappa;                // darkening of hollows, per mm
	float *base, *band;         // ln thickness below all bands; [size][size][B]
	float *weight, *detail;     // of the photograph: weight, and ln luminance without its coarse part
	float *weight_coarse;       // the weight's own coarse mean
	float *light, *part, *wide; // scratch: [size][size], [size][size][4] twice
	int n;                      // texels that count
	int *at;                    // their places
	double noise;               // of one of them, ln luminance
	double hold[B];             // residual of band b's prior at gain 1
};

static bool blur(float *out, const float *in, const struct problem *p, int channels, double sigma, struct err *err)
{
	return cv_blur(out, in, p->size, p->size, channels, sigma * p->scale, err);
}

/* map -= its weighted coarse mean, in each of 4 channels. */
static bool without_coarse(float *map, struct problem *p, struct err *err)
{
	long n = (long)p->size * p->size;
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 4; c++)
			p->wide[4 * i + c] = map[4 * i + c] * p->weight[i];
	if (!blur(p->wide, p->wide, p, 4, p->conf->band[B - 1], err))
		return false;
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 4; c++)
			map[4 * i + c] -= p->wide[4 * i + c] / fmaxf(p->weight_coarse[i], 1e-4f);
	return true;
}

/* part: ln luminance of the filtered relief (channel B) and its derivatives to the gains (0 .. B-1), without their coarse
 * parts. */
static bool render(struct problem *p, const double gain[B], struct err *err)
{
	long n = (long)p->size * p->size;
	float kappa = p->kappa;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		float t = p->base[i], f;
		for (int b = 0; b < B; b++)
			t += (1 + (float)gain[b]) * p->band[B * i + b];
		int k = relief_place(&p->table, t, &f);
		float light = fmaxf(p->table.light[k] + f * (p->table.light[k + 1] - p->table.light[k]), 1e-6f);
		float slope = (p->table.slope[k] + f * (p->table.slope[k + 1] - p->table.slope[k])) / light;
		float thick = expf(t), *part = p->part + 4 * i, *wide = p->wide + 4 * i;
		for (int b = 0; b < B; b++) {
			wide[b] = kappa * thick * p->band[B * i + b];
			part[b] = slope * p->band[B * i + b] + wide[b];
		}
		wide[B] = kappa * thick;
		part[B] = logf(light) + wide[B];
	}
	if (kappa > 0) {
		if (!blur(p->wide, p->wide, p, 4, p->conf->reach, err))
			return false;
		for (long i = 0; i < 4 * n; i++)
			p->part[i] -= p->wide[i];
	}
	return without_coarse(p->part, p, err);
}

static bool residuals(void *ctx, const double *gain, double *r, double *J)
{
	struct problem *p = ctx;
	struct err err = { 0 };
	if (!render(p, gain, &err))
		return false;
	for (int i = 0; i < p->n; i++) {
		const float *s = p->part + 4L * p->at[i];
		double w = p->weight[p->at[i]] / p->noise;
		r[i] = w * (s[B] - p->detail[p->at[i]]);
		for (int b = 0; J && b < B; b++)
			J[i * B + b] = w * s[b];
	}
	for (int b = 0; b < B; b++) {
		r[p->n + b] = gain[b] * p->hold[b];
		for (int c = 0; J && c < B; c++)
			J[(p->n + b) * B + c] = b == c ? p->hold[b] : 0;
	}
	return true;
}

/* ln thickness on the coarser grid, cut into base and bands. */
static bool cut(struct problem *p, const struct image *thickness, struct err *err)
{
	long n = (long)p->size * p->size, full = (long)thickness->width * thickness->height;
	float *one = mem_array((size_t)full, sizeof *one), *at = mem_array((size_t)n, sizeof *at);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < full; i++)
		one[i] = logf(fmaxf(thickness->px[i * thickness->channels], 1e-3f));
	bool ok = cv_resize(at, p->size, p->size, one, thickness->width, thickness->height, 1, err);
	for (int b = 0; ok && b < B; b++) {
		ok = blur(p->base, b ? p->light : at, p, 1, b ? sqrt(pow(p->conf->band[b], 2) - pow(p->conf->band[b - 1], 2)) : p->conf->band[0], err);
		for (long i = 0; i < n; i++)
			p->band[B * i + b] = (b ? p->light[i] : at[i]) - p->base[i];
		memcpy(p->light, p->base, (size_t)n * sizeof *p->base);
	}
	free(one);
	free(at);
	return ok;
}

/* The photograph on the coarser grid: weight, ln luminance. */
static bool look(struct problem *p, const struct image *clean, double extent, const struct pupil *pupil, double root,
                 struct err *err)
{
	long n = (long)p->size * p->size;
	struct image small = image_new(p->size, p->size, 4);
	bool ok = cv_resize(small.px, p->size, p->size, clean->px, clean->width, clean->height, 4, err);
	for (int y = 0; ok && y < p->size; y++) {
		for (int x = 0; x < p->size; x++) {
			long i = (long)y * p->size + x;
			const float *c = small.px + 4 * i;
			double share = iris_share(pupil, root, (2 * (x + 0.5) / p->size - 1) * extent, (2 * (y + 0.5) / p->size - 1) * extent);
			float light = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
			bool use = share > 0.06 && share < 0.92 && c[3] > 0.1f && light > 1e-5f;
			p->weight[i] = use ? fminf(c[3], 1) : 0;
			for (int k = 0; k < 4; k++)
				p->part[4 * i + k] = use ? logf(light) : 0;
			if (use)
				p->at[p->n++] = (int)i;
		}
	}
	image_free(&small);
	if (!ok || !blur(p->weight_coarse, p->weight, p, 1, p->conf->band[B - 1], err) || !without_coarse(p->part, p, err))
		return false;
	for (long i = 0; i < n; i++)
		p->detail[i] = p->part[4 * i];
	return true;
}

static void problem_free(struct problem *p)
{
	float *maps[] = { p->base, p->band, p->weight, p->detail, p->weight_coarse, p->light, p->part, p->wide };
	for (int i = 0; i < COUNT(maps); i++)
		free(maps[i]);
	free(p->at);
	free(p);
}

static struct problem *problem_new(double extent, const struct relief_conf *conf)
{
	struct problem *p = mem_new(1, sizeof *p);
	int size = (int)fmin(fmax(round(2 * extent / conf->pitch), 48), MAP_MAX);
	size_t n = (size_t)size * (size_t)size;
	p->size = size;
	p->scale = size / (2 * extent);
	p->conf = conf;
	float **maps[] = { &p->base, &p->weight, &p->detail, &p->weight_coarse, &p->light };
	for (int i = 0; i < COUNT(maps); i++)
		*maps[i] = mem_array(n, sizeof(float));
	p->band = mem_array(B * n, sizeof(float));
	p->part = mem_array(4 * n, sizeof(float));
	p->wide = mem_array(4 * n, sizeof(float));
	p->at = mem_array(n, sizeof *p->at);
	return p;
}

/* rms difference of ln luminance under these gains; contrast: rms of the photograph's own detail. */
static bool difference(double *rms, double *contrast, struct problem *p, const double gain[B], struct err *err)
{
	double sum = 0, weight = 0, own = 0;
	if (!render(p, gain, err))
		return false;
	for (int i = 0; i < p->n; i++) {
		double d = p->part[4L * p->at[i] + B] - p->detail[p->at[i]], w = p->weight[p->at[i]];
		sum += w * d * d;
		own += w * p->detail[p->at[i]] * p->detail[p->at[i]];
		weight += w;
	}
	*rms = sqrt(sum / weight);
	*contrast = sqrt(own / weight);
	return true;
}

/* Error of the photograph and prior of the relief, both per independent texel: neighbours within the width of the first band are
 * correlated, and count as one. */
static void weigh(struct problem *p)
{
	double one = fmax(p->conf->band[0] * p->scale * 2, 1);
	p->noise = p->conf->model_error * one;
	for (int b = 0; b < B; b++) {
		double sum = 0;
		for (int i = 0; i < p->n; i++) {
			double u = p->weight[p->at[i]] * p->band[B * (long)p->at[i] + b];
			sum += u * u;
		}
		p->hold[b] = sqrt(sum) / (p->conf->relief_sigma * one);
	}
}

bool relief_solve(struct relief_fit *fit, const struct image *clean, const struct image *thickness, double extent,
                  const struct pupil *pupil, double root, const double white[3], const double x[PIGMENT_N],
                  const struct pigment_conf *pigment, const struct relief_conf *conf, struct err *err)
{
	*fit = (struct relief_fit) { 0 };
	struct problem *p = problem_new(extent, conf);
	struct tissue tissue = pigment_tissue(x, pigment);
	relief_table_make(&p->table, conf->low, conf->high, white, x, pigment);
	fit->kappa = conf->occlusion * relief_kappa(&tissue);
	p->kappa = (float)(fit->kappa / conf->reach);
	bool ok = cut(p, thickness, err) && look(p, clean, extent, pupil, root, err);
	if (ok && p->n < 100)
		ok = err_set(err, "iris texture: %d texels were seen: too few for its relief", p->n);
	if (ok) {
		weigh(p);
		float f;
		int k = relief_place(&p->table, logf(0.45f), &f);
		fit->slope = p->table.slope[k] / p->table.light[k];
		ok = difference(&fit->before, &fit->contrast, p, fit->gain, err);
	}
	if (ok && conf->filter) {
		static const double lo[B] = { -1, -1, -1 }, hi[B] = { 6, 6, 6 };
		const struct nls_conf nls = { .max_iter = 30, .ftol = 1e-6 };
		struct nls_result result;
		double cov[B][B];
		ok = nls_solve(&result, B, fit->gain, lo, hi, p->n + B, residuals, p, &nls, &cov[0][0], err);
		fit->iterations = result.iterations;
		for (int b = 0; ok && b < B; b++)
			fit->gain_sigma[b] = sqrt(fmax(cov[b][b], 0));
	}
	ok = ok && difference(&fit->after, &fit->contrast, p, fit->gain, err);
	problem_free(p);
	return ok;
}

bool relief_apply(struct image *out, const struct image *thickness, double extent, const struct relief_fit *fit,
                  const struct relief_conf *conf, struct err *err)
{
	int size = thickness->width;
	long n = (long)size * size;
	double scale = size / (2 * extent);
	*out = image_new(size, size, 1);
	float *sharp = mem_array((size_t)n, sizeof *sharp), *soft = mem_array((size_t)n, sizeof *soft);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++)
		out->px[i] = sharp[i] = logf(fmaxf(thickness->px[i * thickness->channels], 1e-3f));
	bool ok = true;
	for (int b = 0; ok && b < B; b++) {
		double narrower = b ? conf->band[b - 1] : 0;
		ok = cv_blur(soft, sharp, size, size, 1, scale * sqrt(conf->band[b] * conf->band[b] - narrower * narrower), err);
		for (long i = 0; i < n; i++)
			out->px[i] += (float)fit->gain[b] * (sharp[i] - soft[i]);
		float *swap = sharp;
		sharp = soft;
		soft = swap;
	}
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++)
		out->px[i] = fminf(fmaxf(expf(out->px[i]), (float)conf->low), (float)conf->high);
	free(sharp);
	free(soft);
	if (!ok)
		image_free(out);
	return ok;
}
