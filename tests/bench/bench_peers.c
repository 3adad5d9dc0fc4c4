/* Principal components and linear regression beside scikit-learn's, on rows whose singular values and slopes are known:
 * time and error of the same numbers. scikit-learn's rows are there where it is installed (apt-get install python3-sklearn).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/npy/npy.h"
#include "math/linalg.h"
#include "math/regress.h"
#include "math/rng.h"
#include "math/scatter/scatter.h"
#include "tests/lib/bench/bench.h"
#include "tests/peers/peer.h"
#include "tests/lib/scratch.h"

enum { P = 400, K = 12, INPUTS = 40, OUTPUTS = 6, REPS = 5 };
static const char *const of_values = "singular values, worst, of the largest", *const of_lines = "predictions, rms, of their spread";

struct rows {
	long n;
	double *x, *inputs, *outputs, value[K];  // x[n][P]; inputs: its first columns
	double *found, *slopes;                  // ours
	bool kept;
};

static void orthonormal(double *Q, long n, struct rng *rng)
{
	for (int c = 0; c < K; c++) {
		for (long i = 0; i < n; i++)
			Q[i * K + c] = rng_normal(rng);
		for (int pass = 0; pass < 2; pass++) {
			double mean = 0, length = 0;
			for (long i = 0; i < n; i++)
				mean += Q[i * K + c] / (double)n;
			for (long i = 0; i < n; i++)
				Q[i * K + c] -= n > P ? mean : 0;
			for (int b = 0; b < c; b++) {
				double dot = 0;
				for (long i = 0; i < n; i++)
					dot += Q[i * K + b] * Q[i * K + c];
				for (long i = 0; i < n; i++)
					Q[i * K + c] -= dot * Q[i * K + b];
			}
			for (long i = 0; i < n; i++)
				length += Q[i * K + c] * Q[i * K + c];
			for (long i = 0; i < n; i++)
				Q[i * K + c] /= sqrt(length);
		}
	}
}

/* Rank K, singular values from 1000 down to 0.1, a mean as large as a picture's coordinates. */
static struct rows rows_new(long n)
{
	struct rng rng = { 5 };
	struct rows r = { .n = n };
	double *U = mem_new((size_t)n * K, sizeof *U), *V = mem_new((size_t)P * K, sizeof *V), B[INPUTS][OUTPUTS];
	r.x = mem_new((size_t)n * P, sizeof *r.x);
	r.inputs = mem_new((size_t)n * INPUTS, sizeof *r.inputs);
	r.outputs = mem_new((size_t)n * OUTPUTS, sizeof *r.outputs);
	r.found = mem_new(K, sizeof *r.found);
	r.slopes = mem_new((size_t)n * OUTPUTS, sizeof *r.slopes);
	orthonormal(U, n, &rng);
	orthonormal(V, P, &rng);
	for (int c = 0; c < K; c++)
		r.value[c] = 1e3 * pow(1e-4, (double)c / (K - 1));
	for (int i = 0; i < INPUTS * OUTPUTS; i++)
		B[i / OUTPUTS][i % OUTPUTS] = rng_normal(&rng);
	for (long i = 0; i < n; i++)
		for (int j = 0; j < P; j++) {
			double sum = 0;
			for (int c = K - 1; c >= 0; c--)
				sum += U[i * K + c] * r.value[c] * V[j * K + c];
			r.x[i * P + j] = 500 + j + sum;
			for (int o = 0; j < INPUTS && o < OUTPUTS; o++)
				r.outputs[i * OUTPUTS + o] += B[j][o] * sum;
			if (j < INPUTS)
				r.inputs[i * INPUTS + j] = r.x[i * P + j];
		}
	free(U);
	free(V);
	return r;
}

static void components(void *ctx)
{
	struct rows *r = ctx;
	struct scatter s;
	double *v = mem_new((size_t)P * K, sizeof *v);
	scatter_new(&s, P, r->kept ? (int)r->n : 0);
	scatter_add(&s, r->n, r->x, 0);
	scatter_components(v, r->found, &s, 0, P, K);
	scatter_free(&s);
	free(v);
}

static void lines(void *ctx)
{
	struct rows *r = ctx;
	double Gxx[INPUTS * INPUTS], Gxy[INPUTS * OUTPUTS], mx[INPUTS], my[OUTPUTS], b[OUTPUTS * INPUTS];
	double *w = mem_array((size_t)r->n, sizeof *w);
	for (long i = 0; i < r->n; i++)
		w[i] = 1;
	double weight = regress_moments(Gxx, Gxy, mx, my, r->n, INPUTS, OUTPUTS, r->inputs, r->outputs, w);
	regress(b, INPUTS, OUTPUTS, Gxx, Gxy, weight, mx, 0);
	for (long i = 0; i < r->n; i++)
		for (int o = 0; o < OUTPUTS; o++) {
			double sum = my[o];
			for (int j = 0; j < INPUTS; j++)
				sum += b[o * INPUTS + j] * (r->inputs[i * INPUTS + j] - mx[j]);
			r->slopes[i * OUTPUTS + o] = sum;
		}
	free(w);
}

static double values_off(const struct rows *r, const double found[K])
{
	double worst = 0;
	for (int c = 0; c < K; c++)
		worst = fmax(worst, fabs(found[c] - r->value[c]) / r->value[0]);
	return worst;
}

static double lines_off(const struct rows *r, const double *predicted)
{
	double sum = 0, all = 0;
	for (long i = 0; i < r->n * OUTPUTS; i++) {
		sum += (predicted[i] - r->outputs[i]) * (predicted[i] - r->outputs[i]);
		all += r->outputs[i] * r->outputs[i];
	}
	return sqrt(sum / all);
}

static bool give(const char *name, long n, int width, const double *x)
{
	struct err err = { 0 };
	struct npy array = npy_of(NPY_F8, 2, (long[]){ n, width }, x);
	return npy_save(scratch_path("%s.npy", name), &array, &err);
}

static void scikit_learn(const struct rows *r, int reps, const char *setting)
{
	static const char *const methods[] = { "scikit-learn PCA, full", "scikit-learn PCA, randomized", "scikit-learn IncrementalPCA" };
	if (!peer_installed("bench_peers", "sklearn", "python3-sklearn"))
		return;
	give("x", r->n, P, r->x);
	give("inputs", r->n, INPUTS, r->inputs);
	give("outputs", r->n, OUTPUTS, r->outputs);
	char *command = mem_printf("/usr/bin/python3 tests/peers/peer_sklearn.py '%s' %d %d", scratch_path("."), reps, K);
	FILE *from = popen(command, "r");
	for (int i = 0; from && i < COUNT(methods); i++) {
		struct bench_time time = peer_times(from);
		double *found = peer_array(scratch_path("values_%d.npy", i), K);
		bench_row("principal components", methods[i], setting, time, "fit", found ? values_off(r, found) : NAN, "", of_values);
		free(found);
	}
	struct bench_time time = peer_times(from);
	double *predicted = peer_array(scratch_path("predicted.npy"), r->n * OUTPUTS);
	bench_row("linear regression", "scikit-learn LinearRegression", setting, time, "fit", predicted ? lines_off(r, predicted) : NAN, "", of_lines);
	free(predicted);
	if (from)
		pclose(from);
	free(command);
}

int main(int argc, char **argv)
{
	bench_open("peers", argc, argv);
	scratch_open();
	int reps = bench_quick() ? 2 : REPS;
	struct rows r = rows_new(bench_quick() ? 1500 : 6000);
	char *setting = mem_printf("%ld rows, %d columns, rank %d", r.n, P, K), *line = mem_printf("%ld rows, %d inputs, rank %d", r.n, INPUTS, K);
	int threads = linalg_serial();  // as make runs the stages; their own threads take the tiles
	for (int kept = 0; kept < 2; kept++) {
		r.kept = kept;
		struct bench_time time = bench_time(components, &r, reps);
		bench_row("principal components", kept ? "ours, rows kept" : "ours, in one pass", setting, time, "fit", values_off(&r, r.found), "", of_values);
	}
	struct bench_time time = bench_time(lines, &r, reps);
	bench_row("linear regression", "ours", line, time, "fit", lines_off(&r, r.slopes), "", of_lines);
	linalg_threads(threads);
	scikit_learn(&r, reps, setting);
	scratch_close();
	free(setting);
	free(line);
	free(r.x);
	free(r.inputs);
	free(r.outputs);
	free(r.found);
	free(r.slopes);
	return bench_close();
}
