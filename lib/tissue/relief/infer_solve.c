/* The most probable relief, by conjugate gradients, and its sigma, octave by octave. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tissue/relief/bell.h"
#include "tissue/relief/infer_impl.h"

enum { ITERATIONS = 40 };
static const double TOLERANCE = 1e-3;  // of the squared residual: 3 % of it are below the noise

static double dot(const struct infer_grid *g, const float *a, const float *b)
{
	double sum = 0;
	for (long i = 0; i < infer_texels(g); i++)
		sum += (double)a[i] * (double)b[i];
	return sum;
}

/* out = C in: process b is white noise through the root of G_b (1 - G), G what makes a Gaussian of octave b as wide as that of b + 1. */
static void prior(float *out, const float *in, struct infer_grid *g)
{
	const size_t bytes = (size_t)infer_texels(g) * sizeof *out;
	float *half = g->scratch[0], *wide = g->scratch[1];
	memset(out, 0, bytes);
	for (int b = 0; b < B; b++) {
		double p = g->sigma[b], q = g->sigma[b + 1];
		float *space = mem_array((size_t)infer_texels(g), sizeof *space);
		memcpy(half, in, bytes);
		bell_blur(half, g->n, p, 1, space);
		memcpy(wide, half, bytes);
		bell_blur(wide, g->n, sqrt(q * q - p * p), 2, space);
		for (long i = 0; i < infer_texels(g); i++)
			half[i] -= wide[i];
		bell_blur(half, g->n, p, 1, space);
		float factor = (float)(g->variance[b] / (1 / (2 * M_PI * p * p) - 1 / (2 * M_PI * q * q)));
		for (long i = 0; i < infer_texels(g); i++)
			out[i] += factor * half[i];
		free(space);
	}
}

/* out = (P^1/2 A C A^T P^1/2 + 1) m, P the precision; relief = C A^T P^1/2 m. */
static void forward(float *out, float *relief, const float *m, struct infer_grid *g)
{
	float *a = g->scratch[2], *b = g->scratch[3];
	for (long i = 0; i < infer_texels(g); i++)
		a[i] = sqrtf(g->precise[i]) * m[i];
	shading_transposed(b, a, &g->shading);
	prior(relief, b, g);
	shading_apply(a, relief, &g->shading);
	for (long i = 0; i < infer_texels(g); i++)
		out[i] = sqrtf(g->precise[i]) * a[i] + m[i];
}

/* The posterior's mean. */
static void mean_of(float *relief, struct infer_grid *g, struct infer_fit *fit)
{
	size_t n = (size_t)infer_texels(g);
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
static void ways_respond(double out[WAYS], const struct infer_grid *g, int b)
{
	const struct shading *s = &g->shading;
	float slant[SHADING_SLANTS][2];
	double alpha = 0, thick = 0, all = 0, mean[SHADING_SLANTS][2] = { 0 };
	for (long i = 0; i < infer_texels(g); i++) {
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
static void doubt(float *out, const float *relief, const float *variance, const struct infer_grid *g, const struct infer_fit *fit)
{
	double squared[B][WAYS];
	for (int b = 0; b < B; b++)
		ways_respond(squared[b], g, b);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < infer_texels(g); i++) {
		double sum = pow(g->conf->response_error * (double)relief[i], 2);
		for (int b = 0; b < B; b++) {
			double p = fit->rms[b] * fit->rms[b], could = fmin(pow(fit->contrast[b], 2) / (pow(fit->response[b], 2) + 1e-9), g->conf->most * g->conf->most);
			double wrong = ((double)variance[i] * infer_of_noise(g, b) + fit->other[b] * fit->other[b]) / fmax((double)g->weight[i], 1e-3);
			for (int k = 0; k < WAYS; k++) {
				double told = squared[b][k] * p, gain = told / (told + wrong + 1e-12);
				sum += (pow(1 - gain, 2) * fmax(p, could / 2) + gain * (1 - gain) * p) / WAYS;
			}
		}
		out[i] = (float)sqrt(sum);
	}
}


void infer_solve(float *relief, float *sigma, struct infer_fit *fit, struct infer_grid *g, const float *variance)
{
	mean_of(relief, g, fit);
	fit->before = sqrt(infer_square(g, g->off));
	shading_apply(g->scratch[3], relief, &g->shading);
	for (long i = 0; i < infer_texels(g); i++)
		g->scratch[3][i] -= g->off[i];
	fit->after = sqrt(infer_square(g, g->scratch[3]));
	doubt(sigma, relief, variance, g, fit);
}
