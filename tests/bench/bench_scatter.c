/* Light beneath the skin, 1280 x 1024, skin on every pixel: time, and error against the dense profile: every pixel the
 * mean of all others by their distance in the picture and in depth. The picture: a face's curvature, shadows with sharp
 * and with soft edges, and the noise of pores. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "image/subsurface/subsurface.h"
#include "math/rng.h"
#include "tests/lib/bench/bench.h"
#include "tests/peers/subsurface_separable.h"

enum { W = 1280, H = 1024, N = W * H };
static const double PX_PER_MM = 9;  // both eyes across the screen

static struct {
	float light[3][N], out[3][N], depth[N], grain[N];
	struct subsurface_room room;
} *s;

/* A cheek and a brow 30 mm deep; a lid's edge, 3 mm of a step along a curve, where `step`. */
static void draw(bool step)
{
	struct rng rng = { 3 };
	for (int i = 0; i < N; i++)
		s->grain[i] = (float)(0.25 * rng_normal(&rng));
	plane_blur(s->grain, W, H, 1.2);  // pores are some 0.3 mm wide, and a picture resolves nothing below a pixel: 0.06 are left
	for (int i = 0; i < N; i++) {
		double x = (i % W - W / 2) / PX_PER_MM, y = (i / W - H / 2) / PX_PER_MM, noise = 1 + (double)s->grain[i];
		double edge = y - 12 - 0.004 * x * x, soft = 1 / (1 + exp(-(x - 20 - 6 * sin(y / 9)) / 3));
		double z = 900 + 0.006 * (x * x + y * y) + 3 * sin(x / 17) * cos(y / 13);
		s->depth[i] = (float)(z + (step && edge > 0 ? 3 : 0));
		double lit = (0.25 + 0.75 * soft) * (edge > 0 ? 0.35 : 1) * (hypot(x + 40, y + 20) < 8 ? 0.3 : 1) * noise;
		for (int c = 0; c < 3; c++)
			s->light[c][i] = (float)(lit * (c == 0 ? 1 : c == 1 ? 0.95 : 0.9));
	}
}

/* The dense profile at one pixel. */
static void dense(double out[3], const struct subsurface_profile *p, int at)
{
	int x0 = at % W, y0 = at / W, reach = (int)ceil(4 * sqrt(p->variance[p->n - 1]) * PX_PER_MM);
	double sum[SUBSURFACE_MAX][4] = { 0 };
	for (int y = y0 - reach < 0 ? 0 : y0 - reach; y <= y0 + reach && y < H; y++)
		for (int x = x0 - reach < 0 ? 0 : x0 - reach; x <= x0 + reach && x < W; x++) {
			int i = y * W + x;
			double dx = (x - x0) / PX_PER_MM, dy = (y - y0) / PX_PER_MM, dz = (double)s->depth[i] - (double)s->depth[at];
			double d2 = dx * dx + dy * dy + dz * dz;
			for (int k = 0; k < p->n; k++) {
				double w = d2 < 32 * p->variance[k] ? exp(-d2 / (2 * p->variance[k])) : 0;
				for (int c = 0; c < 3 && w > 0; c++)
					sum[k][c] += w * (double)s->light[c][i];
				sum[k][3] += w;
			}
		}
	for (int c = 0; c < 3; c++) {
		out[c] = 0;
		for (int k = 0; k < p->n; k++)
			out[c] += p->weight[k][c] * sum[k][c] / sum[k][3];
	}
}

struct run {
	struct subsurface_profile profile;
	int taps;  // of the separable kernel; 0: ours
};

static void spread(void *ctx)
{
	const struct run *r = ctx;
	struct subsurface_picture p = { W, H, { s->out[0], s->out[1], s->out[2] }, s->depth, PX_PER_MM };
	r->taps ? subsurface_separable(&p, &r->profile, r->taps, &s->room) : subsurface_spread(&p, &r->profile, &s->room);
}

/* What memory allows, all threads: the light and the depth read once and the light written once, the same picture again and
 * again; and what a pyramid moves, each time of another picture: the picture read and a quarter of it written, then the light
 * read again, written, and a quarter of it read. */
enum { COPIES = 8 };

struct stream {
	float *copy[COPIES];  // [3 + 1][N] light and depth, [4][N / 4] the level below
	int n, next;
	bool pyramid;
};

static void down(const float *in, float *below)
{
#pragma omp for schedule(static)
	for (int y = 0; y < H / 2; y++)
		for (int c = 0; c < 4; c++) {
			const float *a = in + (size_t)c * N + (size_t)y * 2 * W, *b = a + W;
			float *out = below + (size_t)c * (N / 4) + (size_t)y * (W / 2);
#pragma omp simd
			for (int x = 0; x < W / 2; x++)
				out[x] = a[x] + a[x + W / 2] + b[x] + b[x + W / 2];
		}
}

static void up(float *light, const float *below, bool pyramid)
{
#pragma omp for schedule(static)
	for (int y = 0; y < H; y++)
		for (int c = 0; c < 3; c++) {
			float *out = light + (size_t)c * N + (size_t)y * W;
			const float *in = pyramid ? below + (size_t)c * (N / 4) + (size_t)(y / 2) * (W / 2) : light + 3 * (size_t)N + (size_t)y * W;
			for (int half = 0; half < W; half += W / 2)
#pragma omp simd
				for (int x = 0; x < W / 2; x++)
					out[half + x] = in[pyramid ? x : half + x] > 0 ? 1.0001f * out[half + x] : out[half + x];
		}
}

static void stream(void *ctx)
{
	struct stream *t = ctx;
	float *picture = t->copy[t->next++ % t->n], *below = picture + 4 * (size_t)N;
#pragma omp parallel
	{
		if (t->pyramid)
			down(picture, below);
		up(picture, below, t->pyramid);
	}
}

static void limits(void)
{
	struct stream t = { .n = 1 };
	for (int k = 0; k < COPIES; k++) {
		t.copy[k] = mem_array(5 * (size_t)N, sizeof(float));
		for (size_t i = 0; i < 5 * (size_t)N; i++)
			t.copy[k][i] = 1;
	}
	bench_row("scattering, a smooth face", "limit: memory", "the light read and written once, from the cache",
	          bench_time(stream, &t, 20), "frame", NAN, "", "");
	t.n = COPIES;
	bench_row("scattering, a smooth face", "limit: memory", "the light read and written once, from memory",
	          bench_time(stream, &t, 20), "frame", NAN, "", "");
	t.pyramid = true;
	bench_row("scattering, a smooth face", "limit: memory", "a pyramid's first level alone: 63 MB, from memory",
	          bench_time(stream, &t, 20), "frame", NAN, "", "");
	for (int k = 0; k < COPIES; k++)
		free(t.copy[k]);
}

enum { PROBES = 400 };

/* Root mean square against the dense profile over the mean of the light, %. */
static double error(const int *at, const double (*truth)[3])
{
	double sum = 0, mean = 0;
	for (int i = 0; i < PROBES; i++)
		for (int c = 0; c < 3; c++) {
			double d = (double)s->out[c][at[i]] - truth[i][c];
			sum += d * d;
			mean += truth[i][c];
		}
	return 100 * sqrt(sum / (3 * PROBES)) / (mean / (3 * PROBES));
}

static void table(const char *name, bool step)
{
	static int at[PROBES];
	static double truth[PROBES][3];
	struct run runs[] = { { subsurface_skin(1.67), 0 }, { subsurface_skin(1.67), 17 }, { subsurface_skin(1.67), 33 } };
	static const char *const names[] = { "Gaussians on a pyramid, depth weights", "separable, pre-integrated (Jimenez 2015)", "separable, pre-integrated (Jimenez 2015)" };
	static const char *const settings[] = { "6 Gaussians", "17 taps", "33 taps" };
	draw(step);
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < PROBES; i++) {
		struct rng own = { (uint64_t)i + 77 };
		at[i] = rng_below(&own, N);
		dense(truth[i], &runs[0].profile, at[i]);
	}
	for (int k = 0; k < 3; k++) {
		memcpy(s->out, s->light, sizeof s->out);
		spread(&runs[k]);
		double e = error(at, (const double(*)[3])truth);
		struct bench_time t = bench_time(spread, &runs[k], bench_quick() ? 3 : 20);
		bench_row(name, names[k], settings[k], t, "frame", e, "%", "root mean square against the dense profile, of the mean");
		if (k)
			continue;
		bench_goal(step ? "scattering in skin: error, a step in depth" : "scattering in skin: error", "<= 1 % RMS from the dense profile", e, "%", e <= 1);
		bench_goal("scattering in skin: time, depth weights, all threads", "<= 3 ms", 1e3 * t.median, "ms", t.median <= 3e-3);
	}
}

int main(int argc, char **argv)
{
	bench_open("scatter", argc, argv);
	s = mem_new(1, sizeof *s);
	table("scattering, a smooth face", false);
	table("scattering, an edge in depth", true);
	subsurface_room_free(&s->room);
	limits();
	free(s);
	return bench_close();
}
