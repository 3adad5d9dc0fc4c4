#include "render/glint.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static double lum(const float *p)
{
	return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

static int compare_floats(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* 0 outside the limbus, 1 iris, 2 pupil. */
static int part(const struct shot *shot, int x, int y)
{
	double u = shot->window[0] + (x + 0.5) * shot->scale, v = shot->window[1] + (y + 0.5) * shot->scale;
	if (ellipse_radius(&shot->fit.limbus, u, v) > 0.88)
		return 0;
	return shot->fit.has_pupil && ellipse_radius(&shot->fit.pupil, u, v) < 0.9 ? 2 : 1;
}

static double iris_median(const struct shot *shot)
{
	const struct image *m = &shot->image;
	float *values = mem_array((size_t)m->width * (size_t)m->height, sizeof *values);
	long n = 0;
	for (int y = 0; y < m->height; y += 2)
		for (int x = 0; x < m->width; x += 2)
			if (part(shot, x, y) == 1)
				values[n++] = (float)lum(image_at(m, x, y));
	qsort(values, (size_t)n, sizeof *values, compare_floats);
	double median = n ? (double)values[n / 2] : 0.2;
	free(values);
	return median;
}

/* Marks what is much brighter than the iris, or, before the pupil's black, simply bright. */
static void mark_bright(unsigned char *marks, const struct shot *shot, double median)
{
	const struct image *m = &shot->image;
	double high = fmin(fmax(2.4 * median, 0.25), 0.85);
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++) {
			double l = lum(image_at(m, x, y));
			if (l < 0.15)
				continue;
			int in = part(shot, x, y);
			marks[(long)y * m->width + x] = in && l > (in == 2 ? 0.15 : high);
		}
}

static void take(struct glint *g, const float *p, int x, int y, double ground)
{
	double w = fmax(lum(p) - ground, 0.01);
	g->n++;
	g->sum += w;
	g->x += w * (x + 0.5);
	g->y += w * (y + 0.5);
	for (int c = 0; c < 3; c++)
		g->rgb[c] += fmax(p[c] - ground, 0.01);
	g->lo[0] = x < g->lo[0] ? x : g->lo[0];
	g->hi[0] = x > g->hi[0] ? x : g->hi[0];
	g->lo[1] = y < g->lo[1] ? y : g->lo[1];
	g->hi[1] = y > g->hi[1] ? y : g->hi[1];
}

/* The glint around a marked pixel; its marks are taken away. stack: room for all pixels. */
static struct glint flood(unsigned char *marks, const struct image *m, int x, int y, double ground, int *stack)
{
	struct glint g = { .lo = { x, y }, .hi = { x, y } };
	int top = 0, w = m->width;
	stack[top++] = y * w + x;
	marks[y * w + x] = 0;
	while (top) {
		int at = stack[--top], u = at % w, v = at / w;
		take(&g, image_at(m, u, v), u, v, ground);
		for (int k = 0; k < 4; k++) {
			int a = u + (k == 0) - (k == 1), b = v + (k == 2) - (k == 3);
			if (a >= 0 && b >= 0 && a < w && b < m->height && marks[b * w + a]) {
				marks[b * w + a] = 0;
				stack[top++] = b * w + a;
			}
		}
	}
	g.x /= g.sum;
	g.y /= g.sum;
	for (int c = 0; c < 3; c++)
		g.rgb[c] /= (double)g.n;
	return g;
}

static void keep(struct glint glints[], int *n, const struct glint *g)
{
	int at = *n < GLINTS_MAX ? *n : GLINTS_MAX - 1;
	if (*n == GLINTS_MAX && glints[at].sum >= g->sum)
		return;
	for (; at > 0 && glints[at - 1].sum < g->sum; at--)
		glints[at] = glints[at - 1];
	glints[at] = *g;
	*n += *n < GLINTS_MAX;
}

int glints_find(struct glint glints[GLINTS_MAX], const struct shot *shot)
{
	const struct image *m = &shot->image;
	size_t all = (size_t)m->width * (size_t)m->height;
	unsigned char *marks = mem_new(all, 1);
	int *stack = mem_array(all, sizeof *stack), n = 0;
	double median = iris_median(shot), a = shot->fit.limbus.a / shot->scale;
	mark_bright(marks, shot, median);
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++)
			if (marks[y * m->width + x]) {
				struct glint g = flood(marks, m, x, y, median / 2, stack);
				// Smaller than that is noise or a wet lash, larger is no lamp.
				if ((double)g.n > 4e-4 * a * a && (double)g.n < 0.5 * a * a)
					keep(glints, &n, &g);
			}
	free(marks);
	free(stack);
	return n;
}
