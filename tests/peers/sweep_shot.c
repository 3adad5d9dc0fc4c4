/* One picture's depth: the planes it is swept by, and its four neighbours on each of them. */
#include "tests/peers/sweep_impl.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"

enum { NEIGHBOURS = 4, WINDOW = 3 };
static const double least_ncc = 0.75;

void shot_lift(double out[3], const struct shot *s, double x, double y, double z)
{
	double v = (y - s->K[1][2]) / s->K[1][1], u = (x - s->K[0][2] - s->K[0][1] * v) / s->K[0][0], p[3] = { u * z, v * z, z };
	mat_tvec(out, s->c->R, p);
	vec_add(out, out, 1, s->c->center);
}

bool shot_drop(double px[3], const struct shot *s, const double world[3])
{
	double d[3], p[3];
	vec_add(d, world, -1, s->c->center);
	mat_vec(p, s->c->R, d);
	px[0] = s->K[0][0] * p[0] / p[2] + s->K[0][1] * p[1] / p[2] + s->K[0][2];
	px[1] = s->K[1][1] * p[1] / p[2] + s->K[1][2];
	px[2] = p[2];
	return p[2] > 0 && px[0] >= 0 && px[1] >= 0 && px[0] <= s->w - 1.001 && px[1] <= s->h - 1.001;
}

/* Mean over a square window, NaN nowhere: borders are cut. */
static void box(float *out, const float *in, int w, int h, float *tmp)
{
	for (int y = 0; y < h; y++) {
		double sum = 0;
		for (int x = 0; x < w + WINDOW; x++) {
			sum += x < w ? (double)in[y * w + x] : 0;
			sum -= x - 2 * WINDOW - 1 >= 0 ? (double)in[y * w + x - 2 * WINDOW - 1] : 0;
			if (x >= WINDOW)
				tmp[y * w + x - WINDOW] = (float)sum;
		}
	}
	const float inverse = 1.0f / (float)((2 * WINDOW + 1) * (2 * WINDOW + 1));
	for (int x = 0; x < w; x++) {
		double sum = 0;
		for (int y = 0; y < h + WINDOW; y++) {
			sum += y < h ? (double)tmp[y * w + x] : 0;
			sum -= y - 2 * WINDOW - 1 >= 0 ? (double)tmp[(y - 2 * WINDOW - 1) * w + x] : 0;
			if (y >= WINDOW)
				out[(y - WINDOW) * w + x] = (float)sum * inverse;
		}
	}
}

struct buffers {
	float *warped, *product, *mean, *square, *cross, *tmp, *own_mean, *own_var, *ncc[NEIGHBOURS];
};

static struct buffers buffers_new(size_t n)
{
	struct buffers b;
	float **all[] = { &b.warped, &b.product, &b.mean, &b.square, &b.cross, &b.tmp, &b.own_mean, &b.own_var,
		              &b.ncc[0], &b.ncc[1], &b.ncc[2], &b.ncc[3] };
	for (int i = 0; i < COUNT(all); i++)
		*all[i] = mem_new(n, sizeof(float));
	return b;
}

static void buffers_free(struct buffers *b)
{
	float *all[] = { b->warped, b->product, b->mean, b->square, b->cross, b->tmp, b->own_mean, b->own_var,
		             b->ncc[0], b->ncc[1], b->ncc[2], b->ncc[3] };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
}

/* The neighbour on the plane of depth z: a homography from three points of it is what shot_lift and shot_drop make of each pixel;
 * linear in homogeneous coordinates, so it is evaluated as one. */
static void warp(float *out, const struct shot *s, const struct shot *o, double z)
{
	double p[3], q[3], d[3], H[3][3], at[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
	for (int k = 0; k < 3; k++) {
		shot_lift(p, s, at[k][0], at[k][1], z);
		vec_add(d, p, -1, o->c->center);
		mat_vec(q, o->c->R, d);
		H[0][k] = o->K[0][0] * q[0] + o->K[0][1] * q[1] + o->K[0][2] * q[2];
		H[1][k] = o->K[1][1] * q[1] + o->K[1][2] * q[2];
		H[2][k] = q[2];
	}
	for (int y = 0; y < s->h; y++)
		for (int x = 0; x < s->w; x++) {
			double h[3];
			for (int k = 0; k < 3; k++)
				h[k] = H[k][0] + x * (H[k][1] - H[k][0]) + y * (H[k][2] - H[k][0]);
			double u = h[0] / h[2], v = h[1] / h[2];
			float *to = &out[(long)y * s->w + x];
			if (!(h[2] > 0 && u >= 0 && v >= 0 && u < o->w - 1 && v < o->h - 1)) {
				*to = 0;
				continue;
			}
			int i = (int)u, j = (int)v;
			float fu = (float)(u - i), fv = (float)(v - j);
			const float *a = o->px + (long)j * o->w + i, *b = a + o->w;
			*to = (a[0] + fu * (a[1] - a[0])) * (1 - fv) + (b[0] + fu * (b[1] - b[0])) * fv;
		}
}

static void correlate(float *ncc, const struct shot *s, const struct shot *o, double z, struct buffers *b)
{
	long n = (long)s->w * s->h;
	warp(b->warped, s, o, z);
	box(b->mean, b->warped, s->w, s->h, b->tmp);
	for (long i = 0; i < n; i++)
		b->product[i] = b->warped[i] * b->warped[i];
	box(b->square, b->product, s->w, s->h, b->tmp);
	for (long i = 0; i < n; i++)
		b->product[i] = b->warped[i] * s->px[i];
	box(b->cross, b->product, s->w, s->h, b->tmp);
	for (long i = 0; i < n; i++) {
		float var = b->square[i] - b->mean[i] * b->mean[i], cov = b->cross[i] - b->mean[i] * b->own_mean[i];
		bool textured = var > 2 && b->own_var[i] > 2;
		ncc[i] = textured ? cov / sqrtf(var * b->own_var[i]) : -1;
	}
}

/* The four views whose direction to the middle differs by about 12 degrees and that stand about as far. */
static void choose(int out[NEIGHBOURS], const struct shot *shots, int n, int i, const double middle[3])
{
	double *cost = mem_array((size_t)n, sizeof *cost), u[3], v[3];
	vec_add(u, shots[i].c->center, -1, middle);
	for (int k = 0; k < n; k++) {
		vec_add(v, shots[k].c->center, -1, middle);
		double angle = acos(fmin(1, vec_dot(u, v) / (vec_norm(u) * vec_norm(v)))) * 180 / M_PI;
		cost[k] = k == i || angle < 3 ? INFINITY : fabs(angle - 12) + 20 * fabs(log(vec_norm(v) / vec_norm(u)));
	}
	for (int k = 0; k < NEIGHBOURS; k++) {
		out[k] = 0;
		for (int j = 0; j < n; j++)
			out[k] = cost[j] < cost[out[k]] ? j : out[k];
		cost[out[k]] = INFINITY;
	}
	free(cost);
}

static double best_two(float *const ncc[NEIGHBOURS], long i)
{
	float a = -1, b = -1;
	for (int k = 0; k < NEIGHBOURS; k++) {
		float v = ncc[k][i];
		b = v > a ? a : v > b ? v : b;
		a = v > a ? v : a;
	}
	return 0.5 * (double)(a + b);
}

void shot_sweep(struct shot *shots, int n_shots, int i_shot, const double middle[3], double low, double high, int planes)
{
	int near[NEIGHBOURS];
	struct shot *s = &shots[i_shot];
	choose(near, shots, n_shots, i_shot, middle);
	long n = (long)s->w * s->h;
	struct buffers b = buffers_new((size_t)n);
	float *score = mem_array((size_t)n * (size_t)planes, sizeof *score);
	box(b.own_mean, s->px, s->w, s->h, b.tmp);
	for (long i = 0; i < n; i++)
		b.product[i] = s->px[i] * s->px[i];
	box(b.own_var, b.product, s->w, s->h, b.tmp);
	for (long i = 0; i < n; i++)
		b.own_var[i] -= b.own_mean[i] * b.own_mean[i];
	for (int d = 0; d < planes; d++) {
		double z = 1 / (1 / high + (1 / low - 1 / high) * d / (planes - 1));
		for (int k = 0; k < NEIGHBOURS; k++)
			correlate(b.ncc[k], s, &shots[near[k]], z, &b);
		for (long i = 0; i < n; i++)
			score[i * planes + d] = (float)best_two(b.ncc, i);
	}
	for (long i = 0; i < n; i++) {
		const float *c = score + i * planes;
		int best = 1;
		for (int d = 1; d < planes - 1; d++)
			best = c[d] > c[best] ? d : best;
		if ((double)c[best] < least_ncc)
			continue;
		double bend = (double)(c[best - 1] - 2 * c[best] + c[best + 1]), shift = bend < 0 ? 0.5 * (double)(c[best - 1] - c[best + 1]) / bend : 0;
		s->depth[i] = (float)(1 / (1 / high + (1 / low - 1 / high) * (best + fmax(-0.5, fmin(0.5, shift))) / (planes - 1)));
	}
	free(score);
	buffers_free(&b);
}
