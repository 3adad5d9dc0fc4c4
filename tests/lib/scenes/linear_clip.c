#include "tests/lib/scenes/linear_clip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"

const struct train_conf train_defaults = {
	.lid_components = 13, .skin_components = 4, .curve_components = 20, .sample = 2048, .block_s = 1, .guard_s = 0.1,
	.folds = 5, .huber = 5, .trim = 40, .min_seen = 0.2, .gap_s = 0.5, .aperture_share = 0.005, .beyond = 0.3, .memory_mb = 1024,
};

static double *numbers(size_t n)
{
	return mem_new(n + 1, sizeof(double));
}

static void maps(struct linear_clip *c, struct rng *rng)
{
	const struct linear_clip_conf *f = &c->conf;
	int n_lid = SKIN_LIDS * f->n_points * 2, from = n_lid + f->n_au, nu = 2 * f->n_vertices;
	double *low = numbers((size_t)(4 * from));
	for (int i = 0; i < n_lid; i++) {
		int eye = i / (n_lid / 2);
		c->l0[i] = f->scale * rng_range(rng, 100, 1000);
		for (int k = 0; k < 5; k++)
			c->P[i * 10 + 5 * eye + k] = rng_normal(rng) * (k == 2 ? 0.05 * f->scale : k < 2 ? 0.3 * f->scale : 0.5);
	}
	// Rank 4: a few directions that mix what the lids and the expressions do.
	for (int i = 0; i < 4 * from; i++)
		low[i] = rng_normal(rng) / (i % from < n_lid ? sqrt(n_lid) : 1 / f->scale / 5);
	for (int i = 0; i < nu; i++) {
		double a[4];
		c->u0[i] = f->scale * rng_range(rng, 0, 1200);
		for (int k = 0; k < 4; k++)
			a[k] = rng_normal(rng);
		for (int j = 0; j < from; j++)
			for (int k = 0; k < 4; k++)
				c->Q[(size_t)i * (size_t)from + (size_t)j] += a[k] * low[k * from + j];
	}
	free(low);
}

/* Fixations of 0.3 s, smooth ways between; a blink every 2 s; apertures follow A otherwise. */
static void inputs(struct linear_clip *c, struct rng *rng)
{
	const struct linear_clip_conf *f = &c->conf;
	int width = SKIN_EYE_INPUTS + f->n_au;
	double from[2] = { 0 }, to[2] = { 0 };
	long step = lround(0.3 * f->fps) + 1;
	for (long i = 0; i < f->n; i++) {
		double *g = c->g + i * width, along = fmin(1, (double)(i % step) / (0.1 * f->fps));
		if (i % step == 0)
			for (int k = 0; k < 2; k++) {
				from[k] = to[k];
				to[k] = rng_range(rng, -20, 20);
			}
		double t = (double)i / f->fps, phase = fmod(t, 2) - 1.2;
		double lid = f->no_blink || phase < 0 || phase > 0.3 ? 1 : fabs(phase - 0.15) < 0.04 ? 0 : fabs(phase - 0.15) / 0.15;
		bool wide = fmod(t, 2) > 1.8 && fmod(t, 2) < 1.9;  // as wide as it goes, once a blink
		for (int e = 0; e < 2; e++) {
			for (int k = 0; k < 2; k++)
				g[5 * e + k] = from[k] + along * (to[k] - from[k]) + (k == 0 ? (e ? 2 : -2) : 0) + 0.7 * sin(t * (1.1 + e + 3 * k));
			g[5 * e + 2] = 2 * sin(0.7 * t + e) + 0.05 * g[5 * e] * g[5 * e + 1] / 20;
			for (int k = 0; k < 2; k++) {
				const double *a = c->A[e][k];
				double control = pow(lid, 1 + 0.4 * e) * (a[0] * g[5 * e] + a[1] * g[5 * e + 1] + a[2]);
				control = wide ? 1 : control;
				g[5 * e + 3 + k] = c->closed[5 * e + 3 + k] + (c->open[5 * e + 3 + k] - c->closed[5 * e + 3 + k]) * control;
			}
		}
		for (int a = 0; a < f->n_au; a++)
			g[SKIN_EYE_INPUTS + a] = fmax(0, sin(2 * M_PI * (t / (1.7 + a) + 0.3 * a)));
		if (f->repeated && i % 2)
			memcpy(g, g - width, (size_t)width * sizeof *g);
	}
}

struct linear_clip *linear_clip_new(const struct linear_clip_conf *conf)
{
	struct linear_clip *c = mem_new(1, sizeof *c);
	struct rng rng = { conf->seed };
	c->conf = *conf;
	int n_lid = SKIN_LIDS * conf->n_points * 2, nu = 2 * conf->n_vertices;
	c->time = numbers((size_t)conf->n);
	c->g = numbers((size_t)conf->n * (size_t)(SKIN_EYE_INPUTS + conf->n_au));
	c->confidence = numbers(2 * (size_t)conf->n);
	c->l0 = numbers((size_t)n_lid);
	c->P = numbers((size_t)n_lid * 10);
	c->u0 = numbers((size_t)nu);
	c->Q = numbers((size_t)nu * (size_t)(n_lid + conf->n_au));
	maps(c, &rng);
	for (int i = 0; i < SKIN_EYE_INPUTS; i++) {
		c->closed[i] = i % 5 >= 3 ? conf->scale * (i % 5 == 3 ? -3 : 4) : 0;
		c->open[i] = i % 5 >= 3 ? conf->scale * (i % 5 == 3 ? 80 : 40) : 0;
	}
	for (int e = 0; e < 2; e++) {
		memcpy(c->A[e][0], (double[]){ 0.001, 0.012, 0.6 }, sizeof c->A[e][0]);
		memcpy(c->A[e][1], (double[]){ -0.0005, -0.01, 0.55 }, sizeof c->A[e][1]);
	}
	inputs(c, &rng);
	for (long i = 0; i < conf->n; i++) {
		c->time[i] = (double)i / conf->fps;
		c->confidence[2 * i] = 1;
		c->confidence[2 * i + 1] = !conf->no_right;
		for (int k = 5; k < 10 && conf->no_right; k++)
			c->g[i * (SKIN_EYE_INPUTS + conf->n_au) + k] = NAN;
	}
	return c;
}

void linear_clip_free(struct linear_clip *c)
{
	free(c->time);
	free(c->g);
	free(c->confidence);
	free(c->l0);
	free(c->P);
	free(c->u0);
	free(c->Q);
	free(c);
}

void linear_clip_truth(double *l, double *u, const struct linear_clip *c, const double *g)
{
	int n_lid = SKIN_LIDS * c->conf.n_points * 2, from = n_lid + c->conf.n_au;
	for (int i = 0; i < n_lid; i++) {
		l[i] = c->l0[i];
		for (int k = 0; k < SKIN_EYE_INPUTS; k++)
			l[i] += c->P[i * 10 + k] != 0 && !isnan(g[k]) ? c->P[i * 10 + k] * g[k] : 0;
	}
	for (int i = 0; i < 2 * c->conf.n_vertices; i++) {
		const double *q = c->Q + (size_t)i * (size_t)from;
		u[i] = c->u0[i];
		for (int j = 0; j < n_lid; j++)
			u[i] += q[j] * (l[j] - c->l0[j]);
		for (int a = 0; a < c->conf.n_au; a++)
			u[i] += q[n_lid + a] * g[SKIN_EYE_INPUTS + a];
	}
}

static bool read_frames(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	struct linear_clip *c = ctx;
	const struct linear_clip_conf *f = &c->conf;
	int n_lid = SKIN_LIDS * f->n_points * 2, nu = 2 * f->n_vertices;
	(void)err;
	for (long i = first; i < first + n; i++, lid += n_lid, skin += nu, seen += f->n_vertices) {
		struct rng rng = { f->seed * 1000003 + (uint64_t)(f->repeated ? i / 2 : i) };
		linear_clip_truth(lid, skin, c, c->g + i * (SKIN_EYE_INPUTS + f->n_au));
		bool out = rng_uniform(&rng) < f->outliers;
		for (int k = 0; k < n_lid; k++) {
			lid[k] += f->noise * rng_normal(&rng) + (out ? 200 * rng_normal(&rng) : 0);
			if (f->no_right && k >= n_lid / 2)
				lid[k] = NAN;
		}
		for (int v = 0; v < f->n_vertices; v++) {
			bool gone = rng_uniform(&rng) < f->missing;
			seen[v] = gone ? 0 : 1;
			for (int k = 0; k < 2; k++)
				skin[2 * v + k] = gone ? NAN : skin[2 * v + k] + f->noise * rng_normal(&rng) + (out ? 200 * rng_normal(&rng) : 0);
		}
	}
	return true;
}

struct train_clip linear_clip_train(struct linear_clip *c)
{
	return (struct train_clip){ .n = c->conf.n, .n_au = c->conf.n_au, .n_points = c->conf.n_points,
		                        .n_vertices = c->conf.n_vertices, .time = c->time, .g = c->g, .confidence = c->confidence,
		                        .read = read_frames, .ctx = c, .place = "clip" };
}
