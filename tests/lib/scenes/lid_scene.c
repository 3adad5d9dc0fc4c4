#include "tests/lib/scenes/lid_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* The circle through two points level with each other, half a width apart, and one `rise` beyond their middle. */
static void arc(double center[2], double *radius, double half, double rise, double x, double y)
{
	*radius = (half * half + rise * rise) / (2 * fabs(rise));
	center[0] = x;
	center[1] = y - rise + (rise > 0 ? *radius : -*radius);
}

double lid_scene_distance(const struct lid_scene *l, double x, double y)
{
	double d = INFINITY;
	for (int k = 0; k < 2; k++)
		d = fmin(d, l->radius[k] - hypot(x - l->center[k][0], y - l->center[k][1]));
	return d;
}

static double covered(const struct lid_scene *l, int x, int y)
{
	enum { FINE = 8 };
	int skin = 0;
	for (int j = 0; j < FINE; j++)
		for (int i = 0; i < FINE; i++)
			skin += lid_scene_distance(l, x + (i + 0.5) / FINE, y + (j + 0.5) / FINE) < 0;
	return skin / (double)(FINE * FINE);
}

void lid_scene_make(struct lid_scene *l, int width, int height, double wide, double high, double lean)
{
	size_t n = (size_t)width * (size_t)height;
	*l = (struct lid_scene){ .material = mem_array(n, 1), .coverage = mem_array(n, sizeof(float)) };
	double up = high * (0.62 - lean), down = high - up;
	arc(l->center[0], &l->radius[0], wide / 2, up, width / 2.0 + 0.3, height / 2.0 + 0.2);
	arc(l->center[1], &l->radius[1], wide / 2, -down, width / 2.0 + 0.3, height / 2.0 + 0.2);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			size_t i = (size_t)y * (size_t)width + (size_t)x;
			double d = lid_scene_distance(l, x + 0.5, y + 0.5);
			l->coverage[i] = (float)(fabs(d) > 2 ? d < 0 : covered(l, x, y));
			l->material[i] = l->coverage[i] >= 0.5f ? DISTANCE_SKIN : DISTANCE_GLOBE;
		}
	l->scene = (struct distance_scene){ .width = width, .height = height, .material = l->material, .coverage = l->coverage };
}

void lid_scene_free(struct lid_scene *l)
{
	free(l->material);
	free(l->coverage);
	free(l->depth);
	*l = (struct lid_scene){ 0 };
}

/* Lower envelope of parabolas over one line of n squared distances. */
static void envelope(double *out, const double *f, int n, int *at, double *edge)
{
	int k = 0;
	at[0] = 0;
	edge[0] = -INFINITY;
	edge[1] = INFINITY;
	for (int q = 1; q < n; q++) {
		double s;
		while ((s = ((f[q] + (double)q * q) - (f[at[k]] + (double)at[k] * at[k])) / (2.0 * (q - at[k]))) <= edge[k])
			k--;
		at[++k] = q;
		edge[k] = s;
		edge[k + 1] = INFINITY;
	}
	k = 0;
	for (int q = 0; q < n; q++) {
		while (edge[k + 1] < q)
			k++;
		out[q] = (double)(q - at[k]) * (q - at[k]) + f[at[k]];
	}
}

void peer_exact(float *out, const struct distance_scene *s)
{
	int w = s->width, h = s->height, n = w > h ? w : h;
	double *d2 = mem_array((size_t)w * (size_t)h, sizeof *d2), *f = mem_array((size_t)n, sizeof *f);
	double *line = mem_array((size_t)n, sizeof *line), *edge = mem_array((size_t)n + 1, sizeof *edge);
	int *at = mem_array((size_t)n, sizeof *at);
	for (int x = 0; x < w; x++) {
		for (int y = 0; y < h; y++)
			f[y] = s->material[y * w + x] == DISTANCE_SKIN ? 0 : 1e12;
		envelope(line, f, h, at, edge);
		for (int y = 0; y < h; y++)
			d2[y * w + x] = line[y];
	}
	for (int y = 0; y < h; y++) {
		envelope(line, d2 + (size_t)y * (size_t)w, w, at, edge);
		for (int x = 0; x < w; x++)
			out[y * w + x] = (float)sqrt(line[x]);
	}
	free(d2);
	free(f);
	free(line);
	free(edge);
	free(at);
}

static double seed_distance(const int32_t seed[2], int x, int y)
{
	return seed[0] < 0 ? INFINITY : (double)(seed[0] - x) * (seed[0] - x) + (double)(seed[1] - y) * (seed[1] - y);
}

static void flood(int32_t (*to)[2], int32_t (*from)[2], int w, int h, int step)
{
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			const int32_t *best = from[y * w + x];
			for (int j = y - step; j <= y + step; j += step)
				for (int i = x - step; i <= x + step; i += step)
					if (i >= 0 && j >= 0 && i < w && j < h && seed_distance(from[j * w + i], x, y) < seed_distance(best, x, y))
						best = from[j * w + i];
			memcpy(to[y * w + x], best, sizeof *to);
		}
}

void peer_jump(float *out, const struct distance_scene *s, struct distance_cost *cost)
{
	int w = s->width, h = s->height, n = w > h ? w : h, step = 1;
	int32_t(*a)[2] = mem_array((size_t)w * (size_t)h, sizeof *a), (*b)[2] = mem_array((size_t)w * (size_t)h, sizeof *b);
	double rounds = 0;
	for (int i = 0; i < w * h; i++) {
		bool skin = s->material[i] == DISTANCE_SKIN;
		a[i][0] = skin ? i % w : -1;
		a[i][1] = skin ? i / w : -1;
	}
	while (step < n)
		step *= 2;
	for (step /= 2; step >= 0; step = step > 1 ? step / 2 : step == 1 ? 0 : -1) {  // ... 4 2 1 1
		flood(b, a, w, h, step ? step : 1);
		int32_t(*swap)[2] = a;
		a = b;
		b = swap;
		rounds++;
	}
	for (int i = 0; i < w * h; i++)
		out[i] = (float)sqrt(seed_distance(a[i], i % w, i / w));
	if (cost)
		*cost = (struct distance_cost){ (double)w * h, 9 * rounds * w * h };
	free(a);
	free(b);
}
