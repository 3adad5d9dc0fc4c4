#include "limbus/propose/seek.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/propose/consensus.h"
#include "limbus/propose/score.h"
#include "math/stats.h"

enum { VOTE_LOW = 10, VOTE_HIGH = 24, PEAKS = 8, RADII = 14, CIRCLES = 3, SHAPES = 9 };

struct peak {
	double x, y, votes;  // level px
};

/* Every pixel with a clear gradient votes for centres along the gradient, on its dark side. */
static void vote(float *acc, const struct grey *g, int high)
{
	const int w = g->width, h = g->height;
	const long n = (long)w * h;
	float *mag = mem_new((size_t)n, sizeof *mag);
	double *sample = mem_array((size_t)(n / 7 + 1), sizeof *sample);
	int ns = 0;
	for (int y = 1; y < h - 1; y++)
		for (int x = 1; x < w - 1; x++) {
			const float *p = g->px + (long)y * w + x;
			mag[(long)y * w + x] = hypotf(p[1] - p[-1], p[w] - p[-w]);
			if (((long)y * w + x) % 7 == 0)
				sample[ns++] = mag[(long)y * w + x];
		}
	const float cut = (float)fmax(stats_quantile(ns, sample, 0.7), 0.012);
	for (int y = 1; y < h - 1; y++)
		for (int x = 1; x < w - 1; x++) {
			const float m = mag[(long)y * w + x];
			if (m < cut)
				continue;
			const float *p = g->px + (long)y * w + x;
			const float dx = (p[-1] - p[1]) / m, dy = (p[-w] - p[w]) / m, weight = sqrtf(fminf(m, 0.3f));
			for (int r = VOTE_LOW; r <= high; r++) {
				int vx = (int)((float)x + dx * (float)r + 0.5f), vy = (int)((float)y + dy * (float)r + 0.5f);
				if (vx < 0 || vy < 0 || vx >= w || vy >= h)
					break;
				acc[(long)vy * w + vx] += weight;
			}
		}
	free(mag);
	free(sample);
}

/* Running mean of 2 radius + 1 along rows, transposed; twice gives a box blur. */
static void box_transposed(float *out, const float *in, int w, int h, int radius)
{
	for (int y = 0; y < h; y++) {
		float sum = 0;
		for (int x = -radius; x < w; x++) {
			if (x + radius < w)
				sum += in[(long)y * w + x + radius];
			if (x - radius - 1 >= 0)
				sum -= in[(long)y * w + x - radius - 1];
			if (x >= 0)
				out[(long)x * h + y] = sum;
		}
	}
}

static void blur(float *acc, int w, int h)
{
	float *t = mem_array((size_t)w * (size_t)h, sizeof *t);
	for (int i = 0; i < 2; i++) {
		box_transposed(t, acc, w, h, 2);
		box_transposed(acc, t, h, w, 2);
	}
	free(t);
}

static int find_peaks(struct peak out[PEAKS], float *acc, int w, int h)
{
	int n = 0;
	for (; n < PEAKS; n++) {
		long best = 0;
		for (long i = 1; i < (long)w * h; i++)
			if (acc[i] > acc[best])
				best = i;
		if (!(acc[best] > 0))
			break;
		int bx = (int)(best % w), by = (int)(best / w);
		out[n] = (struct peak){ bx, by, acc[best] };
		for (int y = by - 5 < 0 ? 0 : by - 5; y <= by + 5 && y < h; y++)
			for (int x = bx - 5 < 0 ? 0 : bx - 5; x <= bx + 5 && x < w; x++)
				acc[(long)y * w + x] = 0;
	}
	return n;
}

/* Rank of a candidate: mainly the length of edge that supports it, so that half a limbus does not outrank the whole as a
 * narrow ellipse. */
static double rank(const struct seek_found *f)
{
	return pow(fmax(f->score, 0), 1.5) * (f->e.a + f->e.b);
}

static void keep(struct seek_found *list, int *n, int max, const struct seek_found *f)
{
	int at = *n;
	while (at > 0 && rank(&list[at - 1]) < rank(f))
		at--;
	if (at >= max)
		return;
	if (*n < max)
		++*n;
	memmove(list + at + 1, list + at, (size_t)(*n - at - 1) * sizeof *list);
	list[at] = *f;
}

/* Circles of several radii around a centre, then tilted shapes of the best, then uphill. */
static struct seek_found around(const struct grey *g, double x, double y, double lo, double hi,
                                const struct seek_conf *conf)
{
	struct seek_found circles[CIRCLES], best = { .score = -1 };
	int n = 0;
	for (int i = 0; i < RADII; i++) {
		double r = lo * pow(hi / lo, (i + 0.5) / RADII);
		struct seek_found f = { { x, y, r, r, 0 }, 0 };
		f.score = score_ellipse(g, &f.e, conf->contrast, SCORE_WIDE);
		keep(circles, &n, CIRCLES, &f);
	}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < SHAPES; j++) {
			double r = circles[i].e.a, ratio = j == 0 ? 1 : j < 5 ? 0.8 : 0.65;
			double angle = j == 0 ? 0 : j < 5 ? (j - 1) * M_PI / 4 : (j - 5) * M_PI / 4 + M_PI / 8;
			struct seek_found f = { { x, y, r / sqrt(ratio), r * sqrt(ratio), angle }, 0 };
			f.score = score_ellipse(g, &f.e, conf->contrast, SCORE_WIDE);
			if (f.score > best.score)
				best = f;
		}
	best.score = score_climb(g, &best.e, 0.12 * best.e.a, 0.03 * best.e.a, conf->contrast, SCORE_WIDE);
	return best;
}

static bool same(const struct ellipse *a, const struct ellipse *b)
{
	double r = fmax(a->a, b->a);
	return hypot(a->cx - b->cx, a->cy - b->cy) < 0.12 * r && fabs(a->a - b->a) < 0.12 * r && fabs(a->b - b->b) < 0.12 * r;
}

static void add(struct seek_found *out, int *n, int max, const struct seek_found *f)
{
	for (int i = 0; i < *n; i++)
		if (same(&out[i].e, &f->e)) {
			if (rank(&out[i]) >= rank(f))
				return;
			memmove(out + i, out + i + 1, (size_t)(*n - i - 1) * sizeof *out);
			--*n;
			break;
		}
	keep(out, n, max, f);
}

static void search_level(struct seek_found out[SEEK_MAX], int *n, const struct pyramid *pyramid, int l,
                         const double *hint, double lo, double hi, const struct seek_conf *conf)
{
	const struct grey *g = &pyramid->level[l];
	const bool last = l + 1 == pyramid->n;
	const int shorter = g->width < g->height ? g->width : g->height;
	const int high = last && shorter / 2 > VOTE_HIGH ? shorter / 2 : VOTE_HIGH;
	double r0 = fmax(lo, 0.85 * VOTE_LOW * g->scale), r1 = fmin(hi, 1.15 * high * g->scale);
	if (r0 >= r1)
		return;
	struct peak peaks[PEAKS];
	int found = 0;
	if (hint) {
		for (int i = 0; i < PEAKS + 1; i++)
			if (found < PEAKS && i != 4)
				peaks[found++] = (struct peak){ (hint[0] + (i % 3 - 1) * 0.25 * hint[2]) / g->scale - 0.5,
				                                (hint[1] + (i / 3 - 1) * 0.25 * hint[2]) / g->scale - 0.5, 1 };
	} else {
		float *acc = mem_new((size_t)g->width * (size_t)g->height, sizeof *acc);
		vote(acc, g, high);
		blur(acc, g->width, g->height);
		found = find_peaks(peaks, acc, g->width, g->height);
		free(acc);
	}
	for (int i = 0; i < found; i++) {
		struct seek_found f = around(g, (peaks[i].x + 0.5) * g->scale, (peaks[i].y + 0.5) * g->scale, r0, r1, conf);
		if (f.score > 0.15)
			add(out, n, SEEK_MAX, &f);
	}
}

int pyramid_index(const struct pyramid *pyramid, double radius, double px)
{
	int l = 0;
	while (l + 1 < pyramid->n && radius / pyramid->level[l].scale > px)
		l++;
	return l;
}

/* Edge score of one ellipse on the level that suits its size. */
static double edge_score(const struct pyramid *pyramid, const struct ellipse *e, const struct seek_conf *conf)
{
	return score_ellipse(&pyramid->level[pyramid_index(pyramid, e->a, 60)], e, conf->contrast, SCORE_NARROW);
}

/* Refines a rough ellipse by RANSAC over the edges near it (consensus.h), then by hill climbing. In whiteness lids are no
 * edges; the arcs between them may be few. */
static void settle(struct seek_found *f, const struct pyramid *pyramid, const struct seek_conf *conf)
{
	const struct grey *g = &pyramid->level[pyramid_index(pyramid, f->e.a, 130)];
	const int w = (int)(pyramid->level[0].width * pyramid->level[0].scale), h = (int)(pyramid->level[0].height * pyramid->level[0].scale);
	struct seek_found as_is = *f;
	for (int i = 0; i < 2; i++)
		if (!rim_consensus(&f->e, g, 0, (i ? 0.09 : 0.2) * f->e.a, 0, w, h))
			break;
	f->score = f->e.b < 0.55 * f->e.a ? 0 : edge_score(pyramid, &f->e, conf);
	as_is.score = edge_score(pyramid, &as_is.e, conf);
	if (as_is.score > f->score)
		*f = as_is;
	f->score = score_climb(g, &f->e, 0.02 * f->e.a, 0.005 * f->e.a, conf->contrast, SCORE_NARROW);
}

bool limbus_seek_outer(struct seek_found *out, const struct pyramid *pyramid, const struct ellipse *inner,
                       const struct seek_conf *conf)
{
	const struct grey *top = &pyramid->level[0];
	const double limit = conf->max_radius * fmin(top->width, top->height) * top->scale;
	struct seek_found best[CIRCLES];
	int n = 0;
	for (double k = 1.25; k * inner->b < limit && k < 7; k *= 1.06)
		for (int i = 0; i < 2; i++) {
			struct seek_found f = { *inner, 0 };
			double round = sqrt(inner->a * inner->b);
			f.e.a = k * (i ? round : inner->a);
			f.e.b = k * (i ? round : inner->b);
			const struct grey *g = &pyramid->level[pyramid_index(pyramid, f.e.a, 60)];
			f.score = score_ellipse(g, &f.e, conf->contrast, SCORE_WIDE);
			keep(best, &n, CIRCLES, &f);
		}
	*out = (struct seek_found){ 0 };
	for (int i = 0; i < n; i++) {
		double a = best[i].e.a;
		const struct grey *g = &pyramid->level[pyramid_index(pyramid, a, 60)];
		best[i].score = score_climb(g, &best[i].e, 0.08 * a, 0.015 * a, conf->contrast, SCORE_WIDE);
		if (best[i].e.b > 1.15 * inner->b && rank(&best[i]) > rank(out))
			*out = best[i];
	}
	if (out->score > 0)
		settle(out, pyramid, conf);
	return out->score > 0;
}

int limbus_seek(struct seek_found out[SEEK_MAX], const struct pyramid *pyramid, const double *hint,
                const struct seek_conf *conf)
{
	const struct grey *top = &pyramid->level[0];
	const double w = top->width * top->scale, h = top->height * top->scale;
	double lo = conf->min_radius * fmax(w, h), hi = conf->max_radius * fmin(w, h);
	if (hint) {
		lo = hint[2] / 1.5;
		hi = hint[2] * 1.5;
	}
	struct seek_found part[PYRAMID_MAX][SEEK_MAX];
	int count[PYRAMID_MAX] = { 0 }, n = 0;
#pragma omp parallel for schedule(dynamic, 1)
	for (int l = 0; l < pyramid->n; l++)
		search_level(part[l], &count[l], pyramid, l, hint, lo, hi, conf);
	for (int l = 0; l < pyramid->n; l++)
		for (int i = 0; i < count[l]; i++)
			add(out, &n, SEEK_MAX, &part[l][i]);
	n = n < conf->candidates ? n : conf->candidates;
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < n; i++)
		settle(&out[i], pyramid, conf);
	struct seek_found sorted[SEEK_MAX];
	int m = 0;
	for (int i = 0; i < n; i++)
		add(sorted, &m, SEEK_MAX, &out[i]);
	memcpy(out, sorted, (size_t)m * sizeof *out);
	return m;
}
