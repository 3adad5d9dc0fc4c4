#include "tissue/relief/infer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "math/rng.h"
#include "tissue/light/iris_light.h"
#include "tissue/relief/bell.h"
#include "tissue/relief/model.h"
#include "tissue/relief/shading.h"
#include "tissue/spread.h"

enum { B = INFER_OCTAVES, GRID_MAX = 640, RINGS = 64, ITERATIONS = 40 };
static const double TOLERANCE = 1e-3;  // of the squared residual: 3 % of it are below the noise

struct grid {
	int n;
	double scale, sigma[B + 1];    // texels a mm; Gaussians between octaves, texels
	const struct infer_conf *conf;
	struct shading shading;
	float *course;                 // ln thickness
	float *weight;                 // 0..1
	float *off;                    // ln luminance that the course does not explain
	float *tint;                   // ln R/B, without its coarse part
	float *precise;                // 1 / variance of `off` in a texel
	double variance[B];            // of the process of each octave, as the conjugate gradients take it
	float *scratch[4];
};

static long texels(const struct grid *g)
{
	return (long)g->n * g->n;
}

static double dot(const struct grid *g, const float *a, const float *b)
{
	double sum = 0;
	for (long i = 0; i < texels(g); i++)
		sum += (double)a[i] * (double)b[i];
	return sum;
}

/* map -= its mean about each place under the weights. */
static bool high_pass(float *map, struct grid *g, double sigma, struct err *err)
{
	float *sum = g->scratch[0], *all = g->scratch[1];
	for (long i = 0; i < texels(g); i++)
		sum[i] = map[i] * g->weight[i];
	if (!cv_blur(sum, sum, g->n, g->n, 1, sigma, err) || !cv_blur(all, g->weight, g->n, g->n, 1, sigma, err))
		return false;
	for (long i = 0; i < texels(g); i++)
		map[i] = g->weight[i] > 0 ? map[i] - sum[i] / fmaxf(all[i], 1e-4f) : 0;
	return true;
}

/* One octave of a map, under the weights; out: scratch or other. */
static bool octave(float *out, const float *map, struct grid *g, int b, struct err *err)
{
	float *sum = g->scratch[0], *all = g->scratch[1];
	for (int k = 0; k < 2; k++) {
		for (long i = 0; i < texels(g); i++)
			sum[i] = map[i] * g->weight[i];
		if (!cv_blur(sum, sum, g->n, g->n, 1, g->sigma[b + k], err) || !cv_blur(all, g->weight, g->n, g->n, 1, g->sigma[b + k], err))
			return false;
		for (long i = 0; i < texels(g); i++)
			out[i] = (k ? out[i] : 0) + (k ? -1 : 1) * sum[i] / fmaxf(all[i], 1e-3f);
	}
	return true;
}

static double square(const struct grid *g, const float *map)
{
	double sum = 0, all = 0;
	for (long i = 0; i < texels(g); i++) {
		sum += (double)g->weight[i] * (double)map[i] * (double)map[i];
		all += (double)g->weight[i];
	}
	return sum / fmax(all, 1e-9);
}

/* Of white noise of variance 1 through octave b. */
static double of_noise(const struct grid *g, int b)
{
	double p = g->sigma[b] * g->sigma[b], q = g->sigma[b + 1] * g->sigma[b + 1];
	return (1 / p + 1 / q - 4 / (p + q)) / (4 * M_PI);
}

/* Process b has the spectrum of (G_b - G_b+1), of variance 1: what octave a of it varies by. */
static double shared(const struct grid *g, int a, int b)
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

/* out = C in: process b is white noise through the root of G_b (1 - G), G what makes a Gaussian of octave b as wide as that of b + 1. */
static void prior(float *out, const float *in, struct grid *g)
{
	const size_t bytes = (size_t)texels(g) * sizeof *out;
	float *half = g->scratch[0], *wide = g->scratch[1];
	memset(out, 0, bytes);
	for (int b = 0; b < B; b++) {
		double p = g->sigma[b], q = g->sigma[b + 1];
		float *space = mem_array((size_t)texels(g), sizeof *space);
		memcpy(half, in, bytes);
		bell_blur(half, g->n, p, 1, space);
		memcpy(wide, half, bytes);
		bell_blur(wide, g->n, sqrt(q * q - p * p), 2, space);
		for (long i = 0; i < texels(g); i++)
			half[i] -= wide[i];
		bell_blur(half, g->n, p, 1, space);
		float factor = (float)(g->variance[b] / (1 / (2 * M_PI * p * p) - 1 / (2 * M_PI * q * q)));
		for (long i = 0; i < texels(g); i++)
			out[i] += factor * half[i];
		free(space);
	}
}

static void grid_free(struct grid *g)
{
	float *maps[] = { g->course, g->weight, g->off, g->tint, g->precise, g->scratch[0], g->scratch[1], g->scratch[2], g->scratch[3] };
	for (int i = 0; i < COUNT(maps); i++)
		free(maps[i]);
	shading_free(&g->shading);
	free(g);
}

static struct grid *grid_new(double extent, const struct infer_conf *conf)
{
	const double pitch = 1.25;  // of the finest Gaussian
	struct grid *g = mem_new(1, sizeof *g);
	g->n = (int)fmin(fmax(round(2 * extent / (pitch * conf->finest)), 48), GRID_MAX);
	g->scale = g->n / (2 * extent);
	g->conf = conf;
	for (int b = 0; b <= B; b++)
		g->sigma[b] = conf->finest * g->scale * (1 << b);
	float **maps[] = { &g->course, &g->weight, &g->off, &g->tint, &g->precise, &g->scratch[0], &g->scratch[1], &g->scratch[2], &g->scratch[3] };
	for (int i = 0; i < COUNT(maps); i++)
		*maps[i] = mem_array((size_t)texels(g), sizeof(float));
	return g;
}

/* A place of the grid, in mm; its iris_share. */
static double share_at(const struct grid *g, long i, double extent, const struct pupil *pupil, double root)
{
	double x = (2 * ((double)(i % g->n) + 0.5) / g->n - 1) * extent, y = (2 * ((double)(i / g->n) + 0.5) / g->n - 1) * extent;
	return iris_share(pupil, root, x, y);
}

/* The thickness' mean over circles round the pupil, ln. */
static bool set_course(struct grid *g, const struct image *thickness, double extent, const struct pupil *pupil, double root, struct err *err)
{
	double sum[RINGS + 1] = { 0 }, all[RINGS + 1] = { 0 };
	long full = (long)thickness->width * thickness->height;
	float *one = mem_array((size_t)full, sizeof *one), *small = g->scratch[0];
	for (long i = 0; i < full; i++)
		one[i] = logf(fmaxf(thickness->px[i * thickness->channels], 1e-3f));
	bool ok = cv_resize(small, g->n, g->n, one, thickness->width, thickness->height, 1, err);
	free(one);
	for (int turn = 0; ok && turn < 2; turn++)
		for (long i = 0; i < texels(g); i++) {
			double at = fmin(fmax(share_at(g, i, extent, pupil, root), 0), 1) * RINGS;
			int k = at < RINGS - 1 ? (int)at : RINGS - 1;
			double t = at - k;
			if (turn) {
				double a = sum[k] / fmax(all[k], 1e-9), b = sum[k + 1] / fmax(all[k + 1], 1e-9);
				g->course[i] = (float)(all[k] > 0 ? all[k + 1] > 0 ? (1 - t) * a + t * b : a : b);
				continue;
			}
			sum[k] += (1 - t) * (double)small[i];
			sum[k + 1] += t * (double)small[i];
			all[k] += 1 - t;
			all[k + 1] += t;
		}
	return ok;
}

/* How the operator stands at each texel, the ln luminance of the course under its light in `off`, and in `tint` what the light's spreading changes
 * of that: beside an edge of the light tissue is lit from beside. */
static bool predict(struct grid *g, const struct relief_table *table, const struct image *light, struct err *err)
{
	float *slope = g->scratch[1], *bare = g->scratch[3], *lit_up = g->precise, *smooth = g->scratch[2], *shade = g->scratch[3];
	for (long i = 0; i < texels(g); i++) {
		double u = ((double)(i % g->n) + 0.5) / g->n * light->width, v = ((double)(i / g->n) + 0.5) / g->n * light->height, lit[IRIS_LIT];
		for (int c = 0; c < IRIS_LIT; c++)
			lit[c] = (double)image_sample(light, u, v, c);
		shading_slants(g->shading.slant[i], g->scale, lit + 4, lit + 6);
		bare[i] = (float)fmax(0.2126 * lit[0] + 0.7152 * lit[1] + 0.0722 * lit[2], 1e-4);
	}
	memcpy(smooth, g->course, (size_t)texels(g) * sizeof *smooth);
	memcpy(lit_up, bare, (size_t)texels(g) * sizeof *lit_up);
	if (!tissue_spread_map(smooth, g->n, 1, g->shading.spread * g->scale, err) || !tissue_spread_map(lit_up, g->n, 1, g->shading.spread * g->scale, err))
		return false;
	for (long i = 0; i < texels(g); i++) {
		float f;
		int k = relief_place(table, smooth[i], &f);
		float here = fmaxf(table->light[k] + f * (table->light[k + 1] - table->light[k]), 1e-6f);
		float lit = fmaxf(lit_up[i], 1e-4f);
		g->off[i] = logf(here * lit);
		g->tint[i] = logf(lit / bare[i]);
		slope[i] = (table->slope[k] + f * (table->slope[k + 1] - table->slope[k])) / here;
		g->shading.thick[i] = 1;  // the course itself shades as a height, not by its logarithm
		g->shading.alpha[i] = 0;
		smooth[i] = expf(g->course[i]);
	}
	shading_apply(shade, smooth, &g->shading);
	for (long i = 0; i < texels(g); i++) {
		g->off[i] += shade[i];
		g->shading.thick[i] = smooth[i];
		g->shading.alpha[i] = slope[i];
	}
	return true;
}

/* What the photograph shows beyond that, and its tint. Returns the number of texels seen; -1, err set, where OpenCV fails. */
static long look(struct grid *g, const struct image *clean, double extent, const struct pupil *pupil, double root, struct err *err)
{
	long seen = 0;
	struct image small = image_new(g->n, g->n, 4);
	if (!cv_resize(small.px, g->n, g->n, clean->px, clean->width, clean->height, 4, err)) {
		image_free(&small);
		return -1;
	}
	for (long i = 0; i < texels(g); i++) {
		const float *c = small.px + 4 * i;
		double share = share_at(g, i, extent, pupil, root);
		float light = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
		bool use = share > 0.03 && share < 0.95 && c[3] > 0.1f && light > 1e-5f && g->precise[i] > 0.01f;
		g->weight[i] = use ? fminf(c[3], 1) : 0;
		g->off[i] = use ? logf(light) - g->off[i] : 0;
		g->tint[i] = use ? logf(fmaxf(c[0], 1e-5f) / fmaxf(c[2], 1e-5f)) : 0;
		seen += use;
	}
	image_free(&small);
	return seen;
}

/* Local variance of white noise, from the contrast of the finest octave (mean size, which few edges hardly change). Into out; its mean. */
static bool noise(float *out, double *mean, const float *map, struct grid *g, struct err *err)
{
	const double over = 0.5, least = 0.003, of_white = of_noise(g, 0);
	float *fine = g->scratch[2], *all = g->scratch[1];
	if (!octave(fine, map, g, 0, err))
		return false;
	for (long i = 0; i < texels(g); i++)
		fine[i] = g->weight[i] * fabsf(fine[i]);
	if (!cv_blur(fine, fine, g->n, g->n, 1, over * g->scale, err) || !cv_blur(all, g->weight, g->n, g->n, 1, over * g->scale, err))
		return false;
	double sum = 0, weight = 0;
	for (long i = 0; i < texels(g); i++) {
		double size = (double)(fine[i] / fmaxf(all[i], 1e-3f));
		out[i] = (float)fmax(M_PI / 2 * size * size / of_white, least * least);
		sum += (double)(g->weight[i] * out[i]);
		weight += (double)g->weight[i];
	}
	*mean = sum / fmax(weight, 1e-9);
	return true;
}

/* Shading's response in octave b: noise through that octave and the operator. */
static bool respond(double *out, struct grid *g, int b, struct err *err)
{
	float *probe = mem_array((size_t)texels(g), sizeof *probe), *lit = mem_array((size_t)texels(g), sizeof *lit);
	struct rng rng = { 7 + (uint64_t)b };
	for (long i = 0; i < texels(g); i++)
		probe[i] = (float)rng_normal(&rng);
	bool ok = octave(lit, probe, g, b, err);
	memcpy(probe, lit, (size_t)texels(g) * sizeof *probe);
	shading_apply(g->scratch[3], probe, &g->shading);
	ok = ok && octave(lit, g->scratch[3], g, b, err) && octave(g->scratch[2], probe, g, b, err);
	*out = ok ? sqrt(square(g, lit) / fmax(square(g, g->scratch[2]), 1e-12)) : 0;
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

/* Melanin's part of the contrast in each octave, squared: from ln R/B, less what thickness and noise change there. */
struct colour {
	double tint, light;        // d ln R/B and d ln luminance by ln melanin
	double tint_of_thickness;  // d ln R/B by ln thickness over d ln luminance by it
};

static struct colour colour_of(const double white[3], const double x[PIGMENT_N], const struct pigment_conf *pigment, const struct relief_conf *relief,
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
	return (struct colour){ (log((double)there.rgb[k][0] / (double)there.rgb[k][2]) - tint) / step,
		                log((double)there.light[k] / (double)here->light[k]) / step, thicker / (fabs(brighter) > 1e-6 ? brighter : 1e-6) };
}

/* How much each octave of relief varies, and what it is worth. */
static bool measure(struct infer_fit *fit, struct grid *g, const struct colour *colour, double most, struct err *err)
{
	double mix[B][B], of[B], p[B], tint_noise, *of_melanin = fit->other;
	float *part = g->scratch[3];
	if (!noise(g->scratch[3], &tint_noise, g->tint, g, err))
		return false;
	for (int b = 0; b < B; b++) {
		if (!respond(&fit->response[b], g, b, err) || !octave(part, g->tint, g, b, err))
			return false;
		double tint = square(g, part) - tint_noise * of_noise(g, b);
		if (!octave(part, g->off, g, b, err))
			return false;
		double contrast = square(g, part), seen = fmax(contrast - fit->noise * fit->noise * of_noise(g, b), 0);
		double own = fmax(tint - pow(colour->tint_of_thickness, 2) * seen, 0);
		fit->contrast[b] = sqrt(contrast);
		of_melanin[b] = fmin(own * pow(colour->light / fmax(fabs(colour->tint), 1e-3), 2), seen);
		of[b] = seen - of_melanin[b];
	}
	for (int a = 0; a < B; a++)
		for (int b = 0; b < B; b++)
			mix[a][b] = shared(g, a, b) * pow(fit->response[b], 2);
	unmix(p, mix, of, most * most);
	for (int a = 0; a < B; a++) {
		double explained = 0, noisy = fit->noise * fit->noise * of_noise(g, a);
		for (int b = 0; b < B; b++)
			explained += mix[a][b] * p[b];
		double other = of_melanin[a] + fmax(of[a] - explained, 0) + g->conf->light_error * g->conf->light_error;
		fit->other[a] = sqrt(other);
		fit->rms[a] = sqrt(p[a]);
		g->variance[a] = p[a] * noisy / (noisy + other);
	}
	return true;
}

/* out = (P^1/2 A C A^T P^1/2 + 1) m, P the precision; relief = C A^T P^1/2 m. */
static void forward(float *out, float *relief, const float *m, struct grid *g)
{
	float *a = g->scratch[2], *b = g->scratch[3];
	for (long i = 0; i < texels(g); i++)
		a[i] = sqrtf(g->precise[i]) * m[i];
	shading_transposed(b, a, &g->shading);
	prior(relief, b, g);
	shading_apply(a, relief, &g->shading);
	for (long i = 0; i < texels(g); i++)
		out[i] = sqrtf(g->precise[i]) * a[i] + m[i];
}

/* The posterior's mean, ln thickness beyond the course. */
static void solve(float *relief, struct grid *g, struct infer_fit *fit)
{
	size_t n = (size_t)texels(g);
	float *m = mem_new(n, sizeof *m), *r = mem_array(n, sizeof *r), *d = mem_array(n, sizeof *d), *q = mem_array(n, sizeof *q);
	for (size_t i = 0; i < n; i++)
		d[i] = r[i] = sqrtf(g->precise[i]) * g->off[i];
	double now = dot(g, r, r), first = now;
	for (int k = 0; k < ITERATIONS && now > TOLERANCE * first; k++) {
		forward(q, relief, d, g);
		double step = now / fmax(dot(g, d, q), 1e-30);
		for (size_t i = 0; i < n; i++) {
			m[i] += (float)step * d[i];
			r[i] -= (float)step * q[i];
		}
		double next = dot(g, r, r);
		for (size_t i = 0; i < n; i++)
			d[i] = r[i] + (float)(next / now) * d[i];
		now = next;
		fit->iterations = k + 1;
	}
	forward(q, relief, m, g);
	free(m);
	free(r);
	free(d);
	free(q);
}

/* Shading's squared response in octave b to waves of WAYS directions, by the light's mean slants: across the light's direction it is weak. */
enum { WAYS = 8 };
static void ways_respond(double out[WAYS], const struct grid *g, int b)
{
	const struct shading *s = &g->shading;
	float slant[SHADING_SLANTS][2];
	double alpha = 0, thick = 0, all = 0, mean[SHADING_SLANTS][2] = { 0 };
	for (long i = 0; i < texels(g); i++) {
		double w = (double)g->weight[i];
		all += w;
		alpha += w * (double)s->alpha[i];
		thick += w * (double)s->thick[i];
		for (int k = 0; k < 2 * SHADING_SLANTS; k++)
			mean[k / 2][k % 2] += w * (double)s->slant[i][k / 2][k % 2];
	}
	for (int k = 0; k < 2 * SHADING_SLANTS; k++)
		slant[k / 2][k % 2] = (float)(mean[k / 2][k % 2] / fmax(all, 1e-9));
	for (int k = 0; k < WAYS; k++) {
		double turn = M_PI * k / WAYS, wave = 0.96 / g->sigma[b];  // where the octave is strongest
		const double at[2] = { wave * cos(turn), wave * sin(turn) };
		out[k] = shading_response(s, alpha / fmax(all, 1e-9), thick / fmax(all, 1e-9), slant, at);
	}
}

/* Standard deviation of ln thickness: of what the octaves leave open, of noise that they let through, and of a response that is off. What an
 * octave varies by is no better known than what part of its contrast is noise: half of what it could be is reckoned with. */
static void doubt(float *out, const float *relief, const float *variance, const struct grid *g, const struct infer_fit *fit, double most)
{
	double square[B][WAYS];
	for (int b = 0; b < B; b++)
		ways_respond(square[b], g, b);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < texels(g); i++) {
		double sum = pow(g->conf->response_error * (double)relief[i], 2);
		for (int b = 0; b < B; b++) {
			double p = fit->rms[b] * fit->rms[b], could = fmin(pow(fit->contrast[b], 2) / (pow(fit->response[b], 2) + 1e-9), most * most);
			double wrong = ((double)variance[i] * of_noise(g, b) + fit->other[b] * fit->other[b]) / fmax((double)g->weight[i], 1e-3);
			for (int k = 0; k < WAYS; k++) {
				double told = square[b][k] * p, gain = told / (told + wrong + 1e-12);
				sum += (pow(1 - gain, 2) * fmax(p, could / 2) + gain * (1 - gain) * p) / WAYS;
			}
		}
		out[i] = (float)sqrt(sum);
	}
}

/* Thickness and its sigma at the texture's resolution. */
static bool compose(struct image *out, const float *relief, const float *sigma, struct grid *g, int size, const struct relief_conf *c, struct err *err)
{
	struct image small = image_new(g->n, g->n, 2);
	*out = image_new(size, size, 2);
	for (long i = 0; i < texels(g); i++) {
		small.px[2 * i] = g->course[i] + relief[i];
		small.px[2 * i + 1] = sigma[i];
	}
	// Between texels of the fit the heights are smooth: their slopes are what shows.
	bool ok = cv_resize(out->px, size, size, small.px, g->n, g->n, 2, err) && (size <= g->n || cv_blur(out->px, out->px, size, size, 2, 0.5 * size / g->n, err));
	for (long i = 0; ok && i < (long)size * size; i++) {
		float mm = fminf(fmaxf(expf(out->px[2 * i]), (float)c->low), (float)c->high);
		out->px[2 * i] = mm;
		out->px[2 * i + 1] *= mm;
	}
	image_free(&small);
	if (!ok)
		image_free(out);
	return ok;
}

/* A texel's precision: of noise, and of light at an edge, which spreads by `edge` (ln). Weights from now on are what is left of the noise's. */
static void weigh(struct grid *g, const float *variance, const float *edge)
{
	for (long i = 0; i < texels(g); i++) {
		double misplaced = g->conf->edge * (double)edge[i];
		g->precise[i] = g->weight[i] / (variance[i] + (float)(misplaced * misplaced));
		g->weight[i] = g->precise[i] * variance[i];
	}
}

static void set_optics(struct grid *g, const double x[PIGMENT_N], const struct pigment_conf *pigment)
{
	const double middle = 0.45;  // mm: of irises
	struct tissue tissue = pigment_tissue(x, pigment);
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, pigment->bands, pigment->illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	shading_make(&g->shading, g->n, g->scale, &tissue, &optics, middle, pigment->cos_view, pigment->cos_light);
}

/* The relief of a grid whose course, light and photograph are known, and its sigma, [n][n] each. sigma: in: what spreading changes of the light. */
static bool solve_grid(float *relief, float *sigma, struct infer_fit *fit, struct grid *g, const struct colour *colour, struct err *err)
{
	float *variance = mem_array((size_t)texels(g), sizeof *variance);
	double mean;
	bool ok = high_pass(g->off, g, g->sigma[B], err) && high_pass(g->tint, g, g->sigma[B], err) && noise(variance, &mean, g->off, g, err);
	if (ok) {
		fit->noise = sqrt(mean);
		weigh(g, variance, sigma);
		ok = measure(fit, g, colour, g->conf->most, err);
	}
	if (ok) {
		solve(relief, g, fit);
		fit->before = sqrt(square(g, g->off));
		shading_apply(g->scratch[3], relief, &g->shading);
		for (long i = 0; i < texels(g); i++)
			g->scratch[3][i] -= g->off[i];
		fit->after = sqrt(square(g, g->scratch[3]));
		doubt(sigma, relief, variance, g, fit, g->conf->most);
	}
	free(variance);
	return ok;
}

bool relief_infer(struct image *out, struct infer_fit *fit, const struct image *clean, const struct image *thickness, const struct image *light,
                  double extent, const struct pupil *pupil, double root, const double white[3], const double x[PIGMENT_N],
                  const struct pigment_conf *pigment, const struct relief_conf *relief, const struct infer_conf *conf, struct err *err)
{
	struct grid *g = grid_new(extent, conf);
	size_t n = (size_t)texels(g);
	float *map = mem_new(n, sizeof *map), *sigma = mem_new(n, sizeof *sigma);
	struct relief_table table;
	*fit = (struct infer_fit){ 0 };
	set_optics(g, x, pigment);
	relief_table_make(&table, relief->low, relief->high, white, x, pigment);
	struct colour colour = colour_of(white, x, pigment, relief, &table);
	bool ok = set_course(g, thickness, extent, pupil, root, err) && predict(g, &table, light, err);
	memcpy(sigma, g->tint, n * sizeof *sigma);  // what spreading changes at edges of the light, until solve_grid fills it
	long seen = ok ? look(g, clean, extent, pupil, root, err) : 0;
	ok = ok && seen >= 0 && (seen >= 100 || err_set(err, "iris texture: %ld texels were seen: too few for its relief", seen));
	ok = ok && solve_grid(map, sigma, fit, g, &colour, err) && compose(out, map, sigma, g, clean->width, relief, err);
	free(map);
	free(sigma);
	grid_free(g);
	return ok;
}
