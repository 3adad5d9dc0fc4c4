/* train: components and regressions of a long clip against LAPACK's decomposition of the whole clip in memory (what the
 * paper's tools do), and against the textbook one-pass sums; held-out error of the linear model and of radial basis
 * functions on rendered clips. */
#include <cblas.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "base/mem.h"
#include "math/linalg.h"
#include "math/rng.h"
#include "math/scatter/scatter.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/linear_clip.h"
#include "tests/lib/truth/tracked.h"

enum { TABLE = 1 << 20, DIRECT_ROWS = 4000, DIRECT_COLUMNS = 500 };

/* A clip of any length that costs little to make: the truth of linear_clip's frames by a product of rank 4, noise from a
 * table. `spent`: seconds that making it took, which are not training's. */
struct cheap {
	struct linear_clip *clip;
	double *noise, spent;
	double *G;  // [2 n_vertices][inputs]: skin straight from the inputs
	double *u0;
};

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool read_cheap(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	struct cheap *c = ctx;
	double start = now_s();
	const struct linear_clip_conf *f = &c->clip->conf;
	int n_lid = SKIN_LIDS * f->n_points * 2, nu = 2 * f->n_vertices, width = SKIN_EYE_INPUTS + f->n_au;
	(void)err;
#pragma omp parallel for
	for (long r = 0; r < n; r++) {
		const double *g = c->clip->g + (first + r) * width, *noise = c->noise;
		unsigned at = (unsigned)((first + r) * 7919);
		for (int i = 0; i < n_lid; i++) {
			double x = c->clip->l0[i];
			for (int k = 0; k < SKIN_EYE_INPUTS; k++)
				x += c->clip->P[i * SKIN_EYE_INPUTS + k] * g[k];
			lid[r * n_lid + i] = x + noise[at++ % TABLE];
		}
		for (int i = 0; i < nu; i++) {
			double x = c->u0[i];
			for (int k = 0; k < width; k++)
				x += c->G[i * width + k] * g[k];
			skin[r * nu + i] = x + noise[at++ % TABLE];
		}
		for (int v = 0; v < f->n_vertices; v++)
			seen[r * f->n_vertices + v] = 1;
	}
	c->spent += now_s() - start;
	return true;
}

static struct cheap cheap_new(long n, int n_vertices)
{
	struct linear_clip_conf f = { .n = n, .n_points = 20, .n_vertices = n_vertices, .n_au = 2, .fps = 60, .scale = 1, .seed = 1 };
	struct cheap c = { .clip = linear_clip_new(&f) };
	int width = SKIN_EYE_INPUTS + f.n_au, nu = 2 * n_vertices, n_lid = SKIN_LIDS * f.n_points * 2;
	struct rng rng = { 3 };
	c.noise = mem_array(TABLE, sizeof *c.noise);
	for (int i = 0; i < TABLE; i++)
		c.noise[i] = 0.3 * rng_normal(&rng);
	c.G = mem_new((size_t)(nu * width), sizeof *c.G);
	c.u0 = mem_new((size_t)nu, sizeof *c.u0);
	double *l = mem_new((size_t)n_lid, sizeof *l), *u = mem_new((size_t)nu, sizeof *u), g[12] = { 0 };
	linear_clip_truth(l, c.u0, c.clip, g);
	for (int k = 0; k < width; k++) {
		g[k] = 1;
		linear_clip_truth(l, u, c.clip, g);
		g[k] = 0;
		for (int i = 0; i < nu; i++)
			c.G[i * width + k] = u[i] - c.u0[i];
	}
	free(l);
	free(u);
	return c;
}

static void cheap_free(struct cheap *c)
{
	linear_clip_free(c->clip);
	free(c->noise);
	free(c->G);
	free(c->u0);
}

static double resident_mib(void)
{
	struct rusage use;
	getrusage(RUSAGE_SELF, &use);
	return (double)use.ru_maxrss / 1024;
}

static double clip_seconds(long n, bool rbf)
{
	struct cheap c = cheap_new(n, 1000);
	struct train_clip clip = linear_clip_train(c.clip);
	struct train_conf conf = train_defaults;
	struct skin_model model;
	struct train_report report;
	struct err err = { 0 };
	clip.read = read_cheap;
	clip.ctx = &c;
	conf.brief = !rbf;
	double start = now_s();
	if (!train_run(&model, &report, &clip, &conf, &err)) {
		fprintf(stderr, "bench_train: %s\n", err.msg);
		exit(1);
	}
	double took = now_s() - start - c.spent;
	skin_model_free(&model);
	train_report_free(&report);
	cheap_free(&c);
	return took;
}

/* What no program that sums every product of two coordinates gets below, in single precision with BLAS on all cores: the
 * lower triangles of as many blocks as the clip has. */
static double products_seconds(long n)
{
	enum { ROWS = 1024, P = 2000 };
	float *r = mem_array(ROWS * P, sizeof *r), *s = mem_new((size_t)P * P, sizeof *s);
	for (int i = 0; i < ROWS * P; i++)
		r[i] = (float)(i % 1013) / 1013 - 0.5f;
	double start = now_s();
	for (long at = 0; at < n; at += ROWS)
		cblas_ssyrk(CblasRowMajor, CblasLower, CblasTrans, P, ROWS, 1, r, P, 1, s, P);
	double took = now_s() - start;
	free(r);
	free(s);
	return took;
}

/* 100 000 frames, 1000 points; what is reported as "error" is the memory. First, so that nothing else has grown. The
 * quicker of two runs counts: one run of many seconds meets other programs. */
static void long_clip(bool rbf)
{
	long n = bench_quick() ? 10000 : 100000;
	int runs = rbf || bench_quick() ? 1 : 2;
	double took[2];
	for (int i = 0; i < runs; i++)
		took[i] = clip_seconds(n, rbf);
	double least = runs > 1 ? fmin(took[0], took[1]) : took[0], mib = resident_mib();
	char setting[64];
	snprintf(setting, sizeof setting, "%ld frames x 2000", n);
	bench_row("speed", rbf ? "one pass, with networks to compare" : "one pass (ours)", setting, bench_time_of(runs, took), "clip", mib,
	          "MiB", "resident memory");
	if (!rbf) {
		double products = products_seconds(n);
		bench_row("speed", "ssyrk of as many rows alone (limit)", setting, bench_time_of(1, &products), "clip", NAN, "", "");
	}
	if (!rbf && n == 100000) {
		bench_goal("training, 100 000 frames x 2000 coordinates", "< 10 s", least, "s", least < 10);
		bench_goal("its memory", "<= 1 GiB", mib, "MiB", mib <= 1024);
	}
}

/* Well-conditioned data: 20 directions falling by a quarter each over noise, means of hundreds of px. */
static double *well_conditioned(long n, int p, double mean)
{
	struct rng rng = { 5 };
	double *v = mem_array((size_t)(20 * p), sizeof *v), *x = mem_array((size_t)n * (size_t)p, sizeof *x);
	for (int i = 0; i < 20 * p; i++)
		v[i] = rng_normal(&rng);
	for (long r = 0; r < n; r++) {
		double a[20], s = 10;
		for (int k = 0; k < 20; k++, s *= 0.75)
			a[k] = s * rng_normal(&rng);
		for (int c = 0; c < p; c++) {
			double sum = mean + 0.3 * rng_normal(&rng);
			for (int k = 0; k < 20; k++)
				sum += a[k] * v[k * p + c];
			x[r * p + c] = sum;
		}
	}
	free(v);
	return x;
}

struct job {
	const double *x;
	double values[20];
};

static void by_svd(void *ctx)
{
	struct job *j = ctx;
	enum { N = DIRECT_ROWS, P = DIRECT_COLUMNS };
	double *y = mem_array((size_t)N * P, sizeof *y), *vt = mem_array((size_t)P * P, sizeof *vt), *u = mem_array((size_t)N * P, sizeof *u);
	double *mean = mem_new(P, sizeof *mean), d[P];
	for (long i = 0; i < (long)N * P; i++)
		mean[i % P] += j->x[i] / N;
	for (long i = 0; i < (long)N * P; i++)
		y[i] = j->x[i] - mean[i % P];
	LAPACKE_dgesdd(LAPACK_ROW_MAJOR, 'S', N, P, y, P, d, u, P, vt, P);
	memcpy(j->values, d, sizeof j->values);
	free(y);
	free(vt);
	free(u);
	free(mean);
}

static void streamed(void *ctx)
{
	struct job *j = ctx;
	struct scatter s;
	double *V = mem_array((size_t)DIRECT_COLUMNS * 20, sizeof *V);
	scatter_new(&s, DIRECT_COLUMNS, 0);
	for (long at = 0; at < DIRECT_ROWS; at += 500)
		scatter_add(&s, 500, j->x + at * DIRECT_COLUMNS, 0);
	scatter_components(V, j->values, &s, 0, DIRECT_COLUMNS, 20);
	scatter_free(&s);
	free(V);
}

/* Sums of x and of x x^T, the mean taken off at the end: one pass, and the digits of the mean lost. */
static void textbook(void *ctx)
{
	struct job *j = ctx;
	enum { N = DIRECT_ROWS, P = DIRECT_COLUMNS };
	double *sum = mem_new(P, sizeof *sum), *S = mem_new((size_t)P * P, sizeof *S), d[P];
	for (long r = 0; r < N; r++)
		for (int a = 0; a < P; a++) {
			sum[a] += j->x[r * P + a];
			for (int b = 0; b <= a; b++)
				S[a * P + b] += j->x[r * P + a] * j->x[r * P + b];
		}
	for (int a = 0; a < P; a++)
		for (int b = 0; b <= a; b++)
			S[a * P + b] -= sum[a] / N * sum[b];
	LAPACKE_dsyevd(LAPACK_ROW_MAJOR, 'V', 'L', P, S, P, d);
	for (int k = 0; k < 20; k++)
		j->values[k] = sqrt(fmax(d[P - 1 - k], 0));
	free(sum);
	free(S);
}

static double worst_relative(const struct job *a, const struct job *b)
{
	double worst = 0;
	for (int k = 0; k < 20; k++)
		worst = fmax(worst, fabs(a->values[k] / b->values[k] - 1));
	return worst;
}

static void exactness(void)
{
	static const double means[] = { 300, 1e6 };
	for (int m = 0; m < 2; m++) {
		double *x = well_conditioned(DIRECT_ROWS, DIRECT_COLUMNS, means[m]);
		struct job job[3] = { { .x = x }, { .x = x }, { .x = x } };
		void (*const fn[])(void *) = { by_svd, streamed, textbook };
		void *const ctx[] = { &job[0], &job[1], &job[2] };
		static const char *const names[] = { "LAPACK dgesdd of all frames (the paper's way)", "one pass (ours)", "one pass, textbook sums" };
		struct bench_time t[3];
		char setting[64];
		int threads = linalg_serial();
		bench_times(3, t, fn, ctx, bench_quick() ? 1 : 3);
		linalg_threads(threads);
		snprintf(setting, sizeof setting, "4000 x 500, mean %g px", means[m]);
		for (int k = 0; k < 3; k++)
			bench_row("components", names[k], setting, t[k], "clip", k ? worst_relative(&job[k], &job[0]) : NAN, "",
			          "20 singular values against dgesdd, worst relative");
		if (!m)
			bench_goal("components of well-conditioned data against direct SVD", "<= 1e-9 relative", worst_relative(&job[1], &job[0]),
			           "", worst_relative(&job[1], &job[0]) <= 1e-9);
		free(x);
	}
}

static void held_out(const char *name, double *ratio)
{
	static const char *const parts[TRAIN_PARTS] = { "left lids", "right lids", "skin" };
	struct tracked tracked;
	struct skin_model model;
	struct train_report r;
	struct err err = { 0 };
	char rel[64], setting[64];
	snprintf(rel, sizeof rel, "video/%s", name);
	if (!bench_data(rel) || !tracked_load(&tracked, bench_data(rel), 1, &err))
		return;
	struct train_clip clip = tracked_clip(&tracked);
	double start = now_s();
	if (train_run(&model, &r, &clip, &train_defaults, &err)) {
		double took = now_s() - start;
		struct bench_time none = { NAN, NAN, NAN }, t = bench_time_of(1, &took);
		for (int p = 0; p < TRAIN_PARTS; p++) {
			int k = p == TRAIN_SKIN ? 3 : 12;
			if (!r.curve[p].n)
				continue;
			snprintf(setting, sizeof setting, "%s, %s, %d components", name, parts[p], k + 1);
			bench_row("held out", "linear (ours, paper's choice)", setting, t, "clip", r.curve[p].linear[k], "", "held-out normalised error");
			bench_row("held out", "radial basis functions (paper's other)", setting, none, "clip", r.curve[p].rbf[k], "",
			          "held-out normalised error");
			bench_row("held out", "components alone", setting, none, "clip", r.curve[p].pca[k], "", "held-out normalised error");
			bench_row("held out", "linear, random frames held out (paper)", setting, none, "clip", r.curve[p].random[k], "",
			          "held-out normalised error");
			*ratio = fmax(*ratio, r.curve[p].linear[k] / r.curve[p].rbf[k]);
		}
		train_report_free(&r);
	}
	skin_model_free(&model);
	tracked_free(&tracked);
}

int main(int argc, char **argv)
{
	bench_open("train", argc, argv);
	long_clip(false);
	if (!bench_quick())
		long_clip(true);
	exactness();
	double ratio = 0;
	held_out("clip_a", &ratio);
	held_out("clip_b", &ratio);
	if (ratio > 0)
		bench_goal("held-out error of lids and skin, linear over radial basis functions, worst", "<= 1.5", ratio, "x", ratio <= 1.5);
	return bench_close();
}
