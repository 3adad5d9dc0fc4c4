#include "tests/lib/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/picture.h"
#include "math/stats.h"
#include "math/vec.h"

enum { NEIGHBOURS = 4, WINDOW = 3, AGREE = 3 };
static const double least_ncc = 0.75;

struct shot {
	float *px;          // grey
	int w, h;
	double K[3][3];     // of the reduced picture, px: first pixel's centre at 0
	const struct views_camera *c;
	float *depth;       // z, 0: none
};

static void focus(double out[3], const struct views_truth *t)
{
	double A[3][3] = { 0 }, b[3] = { 0 }, c[3][3];
	for (int i = 0; i < t->n; i++)
		for (int r = 0; r < 3; r++)
			for (int k = 0; k < 3; k++) {
				double p = (r == k) - t->c[i].R[2][r] * t->c[i].R[2][k];
				A[r][k] += p;
				b[r] += p * t->c[i].center[k];
			}
	for (int i = 0; i < 3; i++)
		vec_cross(c[i], A[(i + 1) % 3], A[(i + 2) % 3]);
	for (int i = 0; i < 3; i++)
		out[i] = (c[0][i] * b[0] + c[1][i] * b[1] + c[2][i] * b[2]) / vec_dot(A[0], c[0]);
}

static bool load(struct shot *s, const struct views_camera *c, const char *images, int shrink, struct err *err)
{
	uint8_t *px, *small;
	int w, h;
	char *path = mem_printf("%s/%s.jpg", images, c->name);
	bool ok = picture_read(&px, &w, &h, path, 100, err);
	free(path);
	if (!ok)
		return false;
	*s = (struct shot){ .w = w / shrink, .h = h / shrink, .c = c };
	small = cv_resize8(px, w, h, 3, s->w, s->h);
	s->px = mem_array((size_t)s->w * (size_t)s->h, sizeof(float));
	s->depth = mem_new((size_t)s->w * (size_t)s->h, sizeof(float));
	for (long i = 0; i < (long)s->w * s->h; i++)
		s->px[i] = small[3 * i + 1];
	double fx = (double)s->w / w, fy = (double)s->h / h;
	memcpy(s->K, c->K, sizeof s->K);
	for (int k = 0; k < 3; k++) {
		s->K[0][k] *= fx;
		s->K[1][k] *= fy;
	}
	// Centres of pixels: half a pixel of the small picture is 0.5 / f of the large one.
	s->K[0][2] += 0.5 * fx - 0.5;
	s->K[1][2] += 0.5 * fy - 0.5;
	free(px);
	free(small);
	return true;
}

/* World point of pixel (x, y) at depth z. */
static void lift(double out[3], const struct shot *s, double x, double y, double z)
{
	double v = (y - s->K[1][2]) / s->K[1][1], u = (x - s->K[0][2] - s->K[0][1] * v) / s->K[0][0], p[3] = { u * z, v * z, z };
	mat_tvec(out, s->c->R, p);
	vec_add(out, out, 1, s->c->center);
}

static bool drop(double px[3], const struct shot *s, const double world[3])
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

/* The neighbour on the plane of depth z: a homography from three points of it is what lift and drop make of each pixel;
 * linear in homogeneous coordinates, so it is evaluated as one. */
static void warp(float *out, const struct shot *s, const struct shot *o, double z)
{
	double p[3], q[3], d[3], H[3][3], at[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
	for (int k = 0; k < 3; k++) {
		lift(p, s, at[k][0], at[k][1], z);
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

static void sweep_one(struct shot *s, const struct shot *shots, const int near[NEIGHBOURS], double low, double high, int planes)
{
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

/* How many other pictures measured the same place. */
static int agreeing(const struct shot *shots, int n, int i, const double world[3])
{
	int agree = 0;
	for (int k = 0; k < n; k++) {
		double px[3];
		if (k == i || !drop(px, &shots[k], world))
			continue;
		double z = (double)shots[k].depth[(long)(px[1] + 0.5) * shots[k].w + (long)(px[0] + 0.5)];
		agree += z > 0 && fabs(z - px[2]) < 0.004 * px[2];
	}
	return agree;
}

static void collect(struct sweep_points *out, const struct shot *shots, int n)
{
	long room = 0;
	for (int i = 0; i < n; i++)
		for (int y = 2; y < shots[i].h - 2; y += 2)
			for (int x = 2; x < shots[i].w - 2; x += 2) {
				const struct shot *s = &shots[i];
				const float *z = s->depth + (long)y * s->w + x;
				double p[5][3], u[3], v[3], normal[3], from[3];
				if (!(z[0] > 0 && z[-2] > 0 && z[2] > 0 && z[-2 * s->w] > 0 && z[2 * s->w] > 0))
					continue;
				lift(p[0], s, x, y, (double)z[0]);
				vec_add(from, p[0], -1, out->center);
				if (vec_norm(from) > out->radius || agreeing(shots, n, i, p[0]) < AGREE)
					continue;
				lift(p[1], s, x - 2, y, (double)z[-2]);
				lift(p[2], s, x + 2, y, (double)z[2]);
				lift(p[3], s, x, y - 2, (double)z[-2 * s->w]);
				lift(p[4], s, x, y + 2, (double)z[2 * s->w]);
				vec_add(u, p[2], -1, p[1]);
				vec_add(v, p[4], -1, p[3]);
				vec_cross(normal, v, u);
				vec_unit(normal, normal);
				if (out->n == room) {
					room = room ? 2 * room : 1 << 16;
					out->xyz = mem_grow(out->xyz, (size_t)room, sizeof *out->xyz);
					out->normal = mem_grow(out->normal, (size_t)room, sizeof *out->normal);
				}
				for (int k = 0; k < 3; k++) {
					out->xyz[out->n][k] = (float)p[0][k];
					out->normal[out->n][k] = (float)normal[k];
				}
				out->n++;
			}
}

bool sweep(struct sweep_points *out, const struct views_truth *truth, const char *images, int shrink, int planes,
           struct err *err)
{
	struct shot *shots = mem_new((size_t)truth->n, sizeof *shots);
	double *far = mem_array((size_t)truth->n, sizeof *far);
	bool ok = true;
	*out = (struct sweep_points){ 0 };
	focus(out->center, truth);
	for (int i = 0; i < truth->n && ok; i++) {
		double d[3];
		ok = load(&shots[i], &truth->c[i], images, shrink, err);
		vec_add(d, truth->c[i].center, -1, out->center);
		far[i] = vec_norm(d);
	}
	// The head fills about a third of the way from its middle to the cameras.
	out->radius = ok ? 0.45 * stats_median(truth->n, far) : 0;
#pragma omp parallel for schedule(dynamic) if (ok)
	for (int i = 0; i < truth->n; i++) {
		int near[NEIGHBOURS];
		double d[3], p[3];
		if (!ok)
			continue;
		choose(near, shots, truth->n, i, out->center);
		vec_add(d, out->center, -1, truth->c[i].center);
		mat_vec(p, truth->c[i].R, d);
		sweep_one(&shots[i], shots, near, fmax(0.1 * out->radius, p[2] - out->radius), p[2] + out->radius, planes);
	}
	if (ok)
		collect(out, shots, truth->n);
	for (int i = 0; i < truth->n; i++) {
		free(shots[i].px);
		free(shots[i].depth);
	}
	free(shots);
	free(far);
	return ok;
}

void sweep_free(struct sweep_points *p)
{
	free(p->xyz);
	free(p->normal);
	*p = (struct sweep_points){ 0 };
}

/* Points sorted into cells of the reach: 27 of them hold all that is near. */
struct sweep_index {
	const struct sweep_points *points;
	double edge, low[3];
	int size[3];
	long *start, *order;
};

static long cell_of(const struct sweep_index *x, const double p[3], int at[3])
{
	for (int k = 0; k < 3; k++) {
		at[k] = (int)floor((p[k] - x->low[k]) / x->edge);
		if (at[k] < 0 || at[k] >= x->size[k])
			return -1;
	}
	return ((long)at[2] * x->size[1] + at[1]) * x->size[0] + at[0];
}

struct sweep_index *sweep_index_new(const struct sweep_points *points, double reach)
{
	struct sweep_index *x = mem_new(1, sizeof *x);
	x->points = points;
	x->edge = reach;
	for (int k = 0; k < 3; k++) {
		x->low[k] = points->center[k] - points->radius - reach;
		x->size[k] = (int)ceil((2 * points->radius + 2 * reach) / reach) + 1;
	}
	long cells = (long)x->size[0] * x->size[1] * x->size[2];
	x->start = mem_new((size_t)cells + 2, sizeof *x->start);
	x->order = mem_array((size_t)points->n, sizeof *x->order);
	for (int pass = 0; pass < 2; pass++) {
		for (long i = 0; i < points->n; i++) {
			double p[3] = { (double)points->xyz[i][0], (double)points->xyz[i][1], (double)points->xyz[i][2] };
			int at[3];
			long c = cell_of(x, p, at);
			if (pass)
				x->order[x->start[c + 1]++] = i;
			else
				x->start[c + 2]++;
		}
		for (long c = 2; c < cells + 2 && !pass; c++)
			x->start[c] += x->start[c - 1];
	}
	return x;
}

double sweep_distance(const struct sweep_index *x, const double xyz[3])
{
	int at[3];
	double best = x->edge * x->edge, along = INFINITY;
	cell_of(x, xyz, at);
	for (int k = 0; k < 27; k++) {
		double near[3];
		int cell[3];
		for (int a = 0; a < 3; a++)
			near[a] = x->low[a] + (at[a] + 0.5 + (a == 0 ? k % 3 : a == 1 ? k / 3 % 3 : k / 9) - 1) * x->edge;
		long c = cell_of(x, near, cell);
		for (long i = c < 0 ? 0 : x->start[c]; c >= 0 && i < x->start[c + 1]; i++) {
			const float *p = x->points->xyz[x->order[i]], *n = x->points->normal[x->order[i]];
			double d[3] = { xyz[0] - (double)p[0], xyz[1] - (double)p[1], xyz[2] - (double)p[2] }, r = vec_dot(d, d);
			if (r < best) {
				best = r;
				along = fabs(d[0] * (double)n[0] + d[1] * (double)n[1] + d[2] * (double)n[2]);
			}
		}
	}
	return along;
}

void sweep_index_free(struct sweep_index *x)
{
	if (x) {
		free(x->start);
		free(x->order);
	}
	free(x);
}
