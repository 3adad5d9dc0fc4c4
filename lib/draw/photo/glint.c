#include "draw/photo/glint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"

static double lum(const float *p)
{
	return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

enum { RINGS = 40, OUTSIDE = -1, PUPIL = -2 };
static const double reach = 0.88;  // share of the limbus: further out the sclera shines through

/* The ring of a pixel round the limbus' centre, or that it lies in the pupil or outside. */
static int ring_at(const struct shot *shot, int x, int y)
{
	double u = shot->window[0] + (x + 0.5) * shot->scale, v = shot->window[1] + (y + 0.5) * shot->scale;
	double r = ellipse_radius(&shot->fit.limbus, u, v);
	if (r >= reach)
		return OUTSIDE;
	return shot->fit.has_pupil && ellipse_radius(&shot->fit.pupil, u, v) < 0.93 ? PUPIL : (int)(r / reach * RINGS);
}

/* A reflection adds white to a colour: the least of the channels shows it on irises of all colours, relative to the upper quartile of
 * its own ring. */
struct survey {
	short *ring;          // of each pixel
	float *least;         // least channel, noise smoothed away
	float level[RINGS];   // upper quarter of a ring's values begins here
	float rgb[RINGS][3];  // median colour: what lies below a glint
};

enum { BINS = 512 };

static int bin_of(float v)
{
	return v > 0 ? v < 1 ? (int)(v * BINS) : BINS - 1 : 0;
}

/* To a thousandth. */
static float quantile(const int count[BINS], double q)
{
	long n = 0, below = 0;
	int k = 0;
	for (int i = 0; i < BINS; i++)
		n += count[i];
	while (k < BINS - 1 && (double)(below + count[k]) < q * (double)n)
		below += count[k++];
	return n ? ((float)k + 0.5f) / BINS : 0;
}

/* Levels of all rings, from histograms of the least channel and of each channel. */
static void survey_rings(struct survey *s, const struct image *m)
{
	int(*count)[4][BINS] = mem_new(RINGS, sizeof *count);
	for (long i = 0; i < (long)m->width * m->height; i++)
		if (s->ring[i] >= 0) {
			count[s->ring[i]][3][bin_of(s->least[i])]++;
			for (int c = 0; c < 3; c++)
				count[s->ring[i]][c][bin_of(m->px[3 * i + c])]++;
		}
	for (int k = 0; k < RINGS; k++) {
		s->level[k] = quantile(count[k][3], 0.75);
		for (int c = 0; c < 3; c++)
			s->rgb[k][c] = quantile(count[k][c], 0.5);
	}
	free(count);
}

static void survey_make(struct survey *s, const struct shot *shot)
{
	const struct image *m = &shot->image;
	long all = (long)m->width * m->height;
	struct err err = { 0 };
	s->ring = mem_array((size_t)all, sizeof *s->ring);
	s->least = mem_array((size_t)all, sizeof *s->least);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++) {
			const float *p = image_at(m, x, y);
			s->ring[(long)y * m->width + x] = (short)ring_at(shot, x, y);
			s->least[(long)y * m->width + x] = fminf(p[0], fminf(p[1], p[2]));
		}
	cv_blur(s->least, s->least, m->width, m->height, 1, 1.2, &err);  // where that fails the noise stays, no more
	survey_rings(s, m);
}

static void mark_bright(unsigned char *marks, const struct survey *s, long n)
{
	for (long i = 0; i < n; i++) {
		int k = s->ring[i];
		if (k == PUPIL)
			marks[i] = s->least[i] > 0.05f;
		else if (k >= 0)
			marks[i] = s->least[i] > fminf(fmaxf(1.6f * s->level[k], s->level[k] + 0.06f), 0.85f);
	}
}

/* ground: the colour below. */
static void take(struct glint *g, const float *p, int x, int y, const float ground[3])
{
	double w = fmax(lum(p) - lum(ground), 0.01);
	g->n++;
	g->sum += w;
	g->x += w * (x + 0.5);
	g->y += w * (y + 0.5);
	for (int c = 0; c < 3; c++)
		g->rgb[c] += fmax(p[c] - ground[c], 0.01);
	g->lo[0] = x < g->lo[0] ? x : g->lo[0];
	g->hi[0] = x > g->hi[0] ? x : g->hi[0];
	g->lo[1] = y < g->lo[1] ? y : g->lo[1];
	g->hi[1] = y > g->hi[1] ? y : g->hi[1];
}

/* The glint around a marked pixel; its marks are taken away. stack: room for all pixels. */
static struct glint flood(unsigned char *marks, const struct image *m, const struct survey *s, int x, int y, int *stack)
{
	struct glint g = { .lo = { x, y }, .hi = { x, y } };
	static const float black[3];
	int top = 0, w = m->width;
	stack[top++] = y * w + x;
	marks[y * w + x] = 0;
	while (top) {
		int at = stack[--top], u = at % w, v = at / w;
		take(&g, image_at(m, u, v), u, v, s->ring[at] >= 0 ? s->rgb[s->ring[at]] : black);
		g.edge = g.edge || s->ring[at] >= RINGS - 1;
		g.over += s->least[at] / fmaxf(s->ring[at] >= 0 ? s->level[s->ring[at]] : 0, 1e-3f);
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
	g.over /= (double)g.n;
	for (int c = 0; c < 3; c++)
		g.rgb[c] /= (double)g.n;
	return g;
}

/* Whether two regions are pieces of one reflection, which may be invisible on the dark margin of the pupil: they face each other across
 * no more than that margin. Returns the pixels between them; -1: they are two. */
static long between(const struct glint *g, const struct glint *h, const struct shot *shot)
{
	for (int i = 0; i < 2 && shot->fit.has_pupil; i++) {
		int low[2], high[2], j = 1 - i;  // where both boxes are; high < low: the gap between them
		for (int k = 0; k < 2; k++) {
			low[k] = g->lo[k] > h->lo[k] ? g->lo[k] : h->lo[k];
			high[k] = g->hi[k] < h->hi[k] ? g->hi[k] : h->hi[k];
		}
		int gap = low[i] - high[i] - 1, both = high[j] - low[j] + 1, size_g = g->hi[j] - g->lo[j] + 1, size_h = h->hi[j] - h->lo[j] + 1;
		double u = shot->window[0] + 0.5 * (low[0] + high[0] + 1) * shot->scale, v = shot->window[1] + 0.5 * (low[1] + high[1] + 1) * shot->scale;
		if (gap <= 0.05 * shot->fit.limbus.a / shot->scale && both > 0.6 * (size_g < size_h ? size_g : size_h) && fabs(ellipse_radius(&shot->fit.pupil, u, v) - 1) < 0.15)
			return gap > 0 ? (long)gap * both : 0;
	}
	return -1;
}

static void join(struct glint *g, const struct glint *h, long gap)
{
	double sum = g->sum + h->sum, n = (double)(g->n + h->n);
	g->x = (g->sum * g->x + h->sum * h->x) / sum;
	g->y = (g->sum * g->y + h->sum * h->y) / sum;
	g->over = ((double)g->n * g->over + (double)h->n * h->over) / n;
	for (int c = 0; c < 3; c++)
		g->rgb[c] = ((double)g->n * g->rgb[c] + (double)h->n * h->rgb[c]) / n;
	g->sum = sum;
	g->n += h->n + gap;
	g->edge = g->edge || h->edge;
	for (int i = 0; i < 2; i++) {
		g->lo[i] = g->lo[i] < h->lo[i] ? g->lo[i] : h->lo[i];
		g->hi[i] = g->hi[i] > h->hi[i] ? g->hi[i] : h->hi[i];
	}
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

/* Joins pieces of one reflection. Returns how many are left. */
static int join_all(struct glint glints[GLINTS_MAX], int n, const struct shot *shot)
{
	struct glint of[GLINTS_MAX];
	int left = 0;
	for (int i = 0; i < n; i++) {
		for (int j = n - 1; j > i; j--) {
			long gap = between(&glints[i], &glints[j], shot);
			if (gap < 0)
				continue;
			join(&glints[i], &glints[j], gap);
			n--;
			memmove(&glints[j], &glints[j + 1], (size_t)(n - j) * sizeof *glints);
		}
		keep(of, &left, &glints[i]);
	}
	memcpy(glints, of, (size_t)left * sizeof *of);
	return left;
}

/* Rejects noise, wet lashes, lids and ragged regions. A small region that is not bright may be a pale fibre of the iris: those are up to
 * twice as light as the upper quartile of their ring, reflections of lamps 2.5 times or more. a: semi-axis of the limbus, px. */
static bool is_lamp(const struct glint *g, double a)
{
	double box = (g->hi[0] - g->lo[0] + 1.0) * (g->hi[1] - g->lo[1] + 1);
	bool bright = fmin(g->rgb[0], fmin(g->rgb[1], g->rgb[2])) > 0.55;
	double least = bright ? 1.5e-4 : g->over > 2.5 ? 2e-3 : 1e-2;
	return !g->edge && (double)g->n > least * a * a && (double)g->n < 0.5 * a * a && (double)g->n > 0.4 * box;
}

int glints_find(struct glint glints[GLINTS_MAX], const struct shot *shot)
{
	const struct image *m = &shot->image;
	size_t all = (size_t)m->width * (size_t)m->height;
	unsigned char *marks = mem_new(all, 1);
	int *stack = mem_array(all, sizeof *stack), n = 0;
	struct survey s;
	survey_make(&s, shot);
	mark_bright(marks, &s, (long)all);
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++)
			if (marks[y * m->width + x]) {
				struct glint g = flood(marks, m, &s, x, y, stack);
				if (is_lamp(&g, shot->fit.limbus.a / shot->scale))
					keep(glints, &n, &g);
			}
	free(s.ring);
	free(s.least);
	free(marks);
	free(stack);
	return join_all(glints, n, shot);
}
