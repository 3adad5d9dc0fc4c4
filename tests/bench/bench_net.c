/* The small networks: ours and OpenCV's dnn, a picture on one thread, at the sizes that limbus and track run them at; and what a network costs before its first
 * picture of a size is through. Error: the largest difference from OpenCV's numbers. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_net.h"
#include "math/rng.h"
#include "net/file.h"
#include "net/net.h"
#include "tests/lib/bench/bench.h"

enum { OURS, OPENCV, METHODS };
static const char *const names[METHODS] = { "ours", "OpenCV's dnn" };

static const struct sized {
	const char *path, *setting;
	int takes[3], gives[3];
} nets[] = {
	{ "config/evidence.onnx", "evidence, 256 x 160", { 3, 160, 256 }, { 6, 80, 128 } },
	{ "config/evidence.onnx", "evidence, 128 x 96", { 3, 96, 128 }, { 6, 48, 64 } },
	{ "config/strip.onnx", "strip, 160 x 64", { 8, 64, 160 }, { 1, 65, 160 } },
	{ "config/occlusion.onnx", "occlusion, 128 x 128", { 8, 128, 128 }, { 4, 64, 64 } },
	{ "config/turn.onnx", "turn, 96 x 96", { 3, 96, 96 }, { 4, 1, 1 } },
	{ "config/odds.onnx", "odds, 1 x 1", { 36, 1, 1 }, { 9, 1, 1 } },
};

struct both {
	const struct sized *of;
	char *onnx;
	size_t bytes;
	struct net *ours;
	struct cv_net *opencv;
	float *in, *out[METHODS];
	struct err err;
};

static void run_ours(void *ctx)
{
	struct both *b = ctx;
	struct net_picture p = { .in = b->in, .height = b->of->takes[1], .width = b->of->takes[2] };
	free(b->out[OURS]);
	net_run(&p, 1, b->ours, b->of->takes[0], &b->err);
	b->out[OURS] = p.out;
}

static void run_opencv(void *ctx)
{
	struct both *b = ctx;
	int size[3] = { b->of->takes[0], b->of->takes[1], b->of->takes[2] };
	free(b->out[OPENCV]);
	b->out[OPENCV] = cv_net_run(b->opencv, b->in, size, &b->err);
}

/* From the file's bytes to the first picture's result. */
static void first_ours(void *ctx)
{
	struct both *b = ctx;
	net_close(b->ours);
	if (net_open(&b->ours, b->of->path, b->of->takes, b->of->gives, &b->err))
		run_ours(b);
}

static void first_opencv(void *ctx)
{
	struct both *b = ctx;
	cv_net_close(b->opencv);
	free(b->onnx);
	b->opencv = net_file_read(&b->onnx, &b->bytes, b->of->path, &b->err) ? cv_net_open(b->onnx, b->bytes, &b->err) : 0;
	if (b->opencv)
		run_opencv(b);
}

/* Adds the medians of a picture's time to sum. */
static void compare(double sum[METHODS], const struct sized *of, int reps)
{
	static void (*const run[METHODS])(void *) = { run_ours, run_opencv }, (*const first[METHODS])(void *) = { first_ours, first_opencv };
	struct both b = { .of = of };
	void *const ctx[METHODS] = { &b, &b };
	struct bench_time first_time[METHODS], time[METHODS];
	struct rng rng = { 1 };
	double most = 0;
	const int n = of->takes[0] * of->takes[1] * of->takes[2];
	b.in = mem_array((size_t)n, sizeof *b.in);
	for (int i = 0; i < n; i++)
		b.in[i] = (float)rng_uniform(&rng);
	bench_times(METHODS, first_time, first, ctx, 5);
	if (!err_is(&b.err))
		bench_times(METHODS, time, run, ctx, reps);
	if (err_is(&b.err)) {
		fprintf(stderr, "%s: %s\n", of->setting, b.err.msg);
		exit(1);
	}
	for (int i = 0; i < of->gives[0] * of->gives[1] * of->gives[2]; i++)
		most = fmax(most, fabs((double)b.out[OURS][i] - (double)b.out[OPENCV][i]));
	for (int m = 0; m < METHODS; m++) {
		bench_row("networks, a picture", names[m], of->setting, time[m], "picture", m == OURS ? most : NAN, "", "against OpenCV's");
		bench_row("networks, opened and a first picture", names[m], of->setting, first_time[m], "network", NAN, "", "");
		free(b.out[m]);
		sum[m] += time[m].median;
	}
	net_close(b.ours);
	cv_net_close(b.opencv);
	free(b.onnx);
	free(b.in);
}

int main(int argc, char **argv)
{
	double sum[METHODS] = { 0 };
	bench_open("net", argc, argv);
	for (int i = 0; i < COUNT(nets); i++)
		compare(sum, &nets[i], bench_quick() ? 9 : 41);
	const double times = sum[OPENCV] / sum[OURS];
	bench_goal("networks, one picture of each: times as fast as OpenCV's dnn", ">= 1.7", times, "", times >= 1.7);
	return bench_close();
}
