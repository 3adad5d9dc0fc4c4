/* Lays frames of a film onto the person's chart. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "image/image.h"
#include "math/stats.h"
#include "math/vec.h"

static const double facing_least = 0.3;  // cosine: skin seen at a flatter angle is left out
/* Of the white that is seen. On 24 heads by another renderer skin by all of it has 0.20 too little ln R/G, by a quarter 0.03, 0.10 from head to head. */
static const double bare_share = 0.25;
static const float hidden_mm = 1.0f;     // behind what the frame shows there
enum { DARK = 3, BRIGHT = 251, WHITE_LEAST = 200 };

struct frame {
	const struct complexion_view *view;
	float *near;             // [height][width] mm before the camera
};

/* Depth of the mesh's outsides. */
static void depths(struct frame *f, const struct mesh *m)
{
	const struct complexion_view *v = f->view;
	for (long i = 0; i < (long)v->width * v->height; i++)
		f->near[i] = INFINITY;
	for (int t = 0; t < m->n_faces; t++) {
		const float *a = v->at[m->faces[t][0]], *b = v->at[m->faces[t][1]], *c = v->at[m->faces[t][2]];
		const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
		if (!(area < 0))  // NAN, too
			continue;
		const int y0 = (int)fmaxf(ceilf(fminf(fminf(a[1], b[1]), c[1]) - 0.5f), 0), y1 = (int)fminf(fmaxf(fmaxf(a[1], b[1]), c[1]) - 0.5f, (float)v->height - 1);
		const int x0 = (int)fmaxf(ceilf(fminf(fminf(a[0], b[0]), c[0]) - 0.5f), 0), x1 = (int)fminf(fmaxf(fmaxf(a[0], b[0]), c[0]) - 0.5f, (float)v->width - 1);
		for (int y = y0; y <= y1; y++)
			for (int x = x0; x <= x1; x++) {
				const float px = (float)x + 0.5f - a[0], py = (float)y + 0.5f - a[1];
				const float wb = (px * (c[1] - a[1]) - py * (c[0] - a[0])) / area, wc = (py * (b[0] - a[0]) - px * (b[1] - a[1])) / area;
				if (wb < -1e-4f || wc < -1e-4f || wb + wc > 1.0001f)
					continue;
				float *near = &f->near[(long)y * v->width + x];
				*near = fminf(*near, a[2] + wb * (b[2] - a[2]) + wc * (c[2] - a[2]));
			}
	}
}

/* Cosine of the angle at which a face is seen: its area in the frame over that of the face turned to the camera. */
static double facing(const struct complexion_view *v, const struct mesh *m, int face)
{
	const int32_t *t = m->faces[face];
	const float *a = v->at[t[0]], *b = v->at[t[1]], *c = v->at[t[2]];
	double e[3], g[3], n[3], px = v->focal_px / (double)((a[2] + b[2] + c[2]) / 3);
	for (int k = 0; k < 3; k++) {
		e[k] = (double)m->vertices[t[1]][k] - (double)m->vertices[t[0]][k];
		g[k] = (double)m->vertices[t[2]][k] - (double)m->vertices[t[0]][k];
	}
	vec_cross(n, e, g);
	const double seen = (double)((b[1] - a[1]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[1] - a[1]));
	return fmin(seen / fmax(vec_norm(n) * px * px, 1e-12), 1);
}

/* Whether skin at that place of the frame is what the frame shows there. */
static bool in_sight(const struct frame *f, double x, double y, float depth)
{
	const struct complexion_view *v = f->view;
	for (int k = 0; k < 9; k++) {
		const long at = ((long)y + k / 3 - 1) * v->width + (long)x + k % 3 - 1;
		if (v->open[at] || depth > f->near[at] + hidden_mm)
			return false;
	}
	return true;
}

static void texel(uint8_t out[4], const struct complexion *c, const struct frame *f, const struct complexion_spot *spot, const float *cosine)
{
	const struct complexion_view *v = f->view;
	double at[3] = { 0 }, rgb[3] = { 0 };
	memset(out, 0, 4);
	if (spot->face < 0 || !(cosine[spot->face] > (float)facing_least))
		return;
	for (int k = 0; k < 3; k++) {
		const float w = k == 0 ? 1 - spot->w[0] - spot->w[1] : spot->w[k - 1];
		for (int i = 0; i < 3; i++)
			at[i] += (double)(w * v->at[c->mesh->faces[spot->face][k]][i]);
	}
	if (!(at[0] > 3 && at[1] > 3 && at[0] < v->width - 3 && at[1] < v->height - 3) || !in_sight(f, at[0], at[1], (float)at[2]))
		return;
	const int x = (int)(at[0] - 0.5), y = (int)(at[1] - 0.5);
	const double fx = at[0] - 0.5 - x, fy = at[1] - 0.5 - y;
	for (int j = 0; j < 4; j++) {
		const uint8_t *p = v->rgb + 3 * ((long)(y + j / 2) * v->width + x + j % 2);
		for (int i = 0; i < 3; i++) {
			if (p[i] > BRIGHT)
				return;
			rgb[i] += (j % 2 ? fx : 1 - fx) * (j / 2 ? fy : 1 - fy) * p[i];
		}
	}
	if (rgb[0] < DARK)
		return;
	for (int i = 0; i < 3; i++)
		out[i] = (uint8_t)lrint(rgb[i]);
	out[3] = (uint8_t)lrintf(255 * cosine[spot->face] * cosine[spot->face]);
}

/* Linear colour of a pixel's surroundings of 3 by 3. */
static void around(double rgb[3], const struct complexion_view *v, long at)
{
	for (int k = 0; k < 3; k++) {
		rgb[k] = 0;
		for (int j = 0; j < 9; j++)
			rgb[k] += (double)linear_from_srgb((float)v->rgb[3 * (at + (j / 3 - 1) * (long)v->width + j % 3 - 1) + k] / 255) / 9;
	}
}

/* White of the eyes: of what stands open, well inside, the brighter but for lights mirrored there; of that what is least red: the rest has vessels over it. */
static void white_of(double white[3], const struct complexion_view *v)
{
	enum { INSIDE = 3 };
	const uint8_t *open = v->eyes ? v->eyes : v->open;
	const size_t size = (size_t)v->width * (size_t)v->height + 1;
	int n = 0, most = 0, clipped[3] = { 0, 0, 0 };
	double *grey = mem_new(size, sizeof *grey), *sorted = mem_new(size, sizeof *sorted), sum[3] = { 0 };
	long *at = mem_new(size, sizeof *at), many = 0;
	for (int y = INSIDE; y < v->height - INSIDE; y++)
		for (int x = INSIDE; x < v->width - INSIDE; x++) {
			const long i = (long)y * v->width + x;
			if (!open[i] || !open[i - INSIDE] || !open[i + INSIDE] || !open[i - (long)INSIDE * v->width] || !open[i + (long)INSIDE * v->width])
				continue;
			at[n] = i;
			grey[n++] = v->rgb[3 * i] + 2 * v->rgb[3 * i + 1] + v->rgb[3 * i + 2];
		}
	memcpy(sorted, grey, (size_t)n * sizeof *sorted);
	const double low = n ? stats_quantile(n, sorted, 0.65) : 0, high = n ? stats_quantile(n, sorted, 0.92) : 0;
	double *red = sorted, all = 0;
	for (int i = 0; i < n; i++)
		if (grey[i] >= low && grey[i] <= high) {
			double rgb[3];
			around(rgb, v, at[i]);
			at[most] = at[i];
			grey[most] = red[most] = rgb[0] / fmax(rgb[1], 1e-9);
			all += rgb[1];
			most++;
		}
	const double bare = most ? stats_quantile(most, red, bare_share) : 0;
	for (int i = 0; i < most; i++)
		if (grey[i] <= bare) {
			double rgb[3];
			around(rgb, v, at[i]);
			for (int k = 0; k < 3; k++) {
				sum[k] += rgb[k];
				clipped[k] += v->rgb[3 * at[i] + k] > BRIGHT;
			}
			many++;
		}
	// Its colour, but as bright as all of it: where it is bare it may be lit otherwise.
	const double level = most && sum[1] > 0 ? all / most / sum[1] : 0;
	for (int k = 0; k < 3; k++)
		white[k] = most >= WHITE_LEAST && clipped[k] * 10 < many ? sum[k] * level : 0;
	free(sorted);
	free(grey);
	free(at);
}

void complexion_add(struct complexion *c, const struct complexion_view *v)
{
	const struct mesh *m = c->mesh;
	const long n = (long)c->side * c->side;
	if (c->n_views == COMPLEXION_VIEWS)
		return;
	struct frame f = { v, mem_array((size_t)v->width * (size_t)v->height + 1, sizeof *f.near) };
	float *cosine = mem_array((size_t)m->n_faces + 1, sizeof *cosine);
	depths(&f, m);
	for (int t = 0; t < m->n_faces; t++)
		cosine[t] = (float)facing(v, m, t);
	uint8_t (*to)[4] = c->view[c->n_views++] = mem_array((size_t)n + 1, sizeof *to);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++)
		texel(to[i], c, &f, &c->spot[i], cosine);
	if (c->n_views == 1)
		white_of(c->white, v);
	complexion_add_lashes(c, v);
	free(cosine);
	free(f.near);
}

/* Exposure of a frame over that of the first: median over what both show. */
static double gain_of(const struct complexion *c, int view, const float linear[256])
{
	const long n = (long)c->side * c->side, step = n / 40000 + 1;
	double *ratio = mem_new((size_t)(n / step) + 1, sizeof *ratio);
	int many = 0;
	for (long i = 0; i < n; i += step)
		if (c->view[view][i][3] && c->view[0][i][3])
			ratio[many++] = (double)(linear[c->view[view][i][1]] / linear[c->view[0][i][1]]);
	const double gain = many > 50 ? stats_median(many, ratio) : 1;
	free(ratio);
	return gain;
}

struct shown {
	float rgb[3], grey, weight;
};

/* What most frames show: the weighted median of the luminance, then the mean of those near it. Returns its weight. */
static float most(float rgb[3], struct shown *s, int n)
{
	float all = 0, half = 0, sum = 0;
	for (int i = 1; i < n; i++)
		for (int k = i; k > 0 && s[k].grey < s[k - 1].grey; k--) {
			const struct shown t = s[k];
			s[k] = s[k - 1];
			s[k - 1] = t;
		}
	for (int i = 0; i < n; i++)
		all += s[i].weight;
	int m = 0;
	while (m + 1 < n && half + s[m].weight < 0.5f * all)
		half += s[m++].weight;
	for (int i = 0; i < n; i++)
		if (fabsf(s[i].grey - s[m].grey) <= 0.1f * s[m].grey) {
			for (int k = 0; k < 3; k++)
				rgb[k] += s[i].weight * s[i].rgb[k];
			sum += s[i].weight;
		}
	for (int k = 0; k < 3; k++)
		rgb[k] /= sum;
	return sum;
}

void complexion_gather(float (*ln)[3], float *weight, const struct complexion *c)
{
	float linear[256];
	double gain[COMPLEXION_VIEWS] = { 1 };
	for (int i = 0; i < 256; i++)
		linear[i] = linear_from_srgb(fmaxf((float)i, 0.5f) / 255);
	for (int k = 1; k < c->n_views; k++)
		gain[k] = gain_of(c, k, linear);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < (long)c->side * c->side; i++) {
		struct shown s[COMPLEXION_VIEWS];
		int n = 0;
		float rgb[3] = { 0 };
		for (int k = 0; k < c->n_views; k++) {
			const uint8_t *p = c->view[k][i];
			if (!p[3])
				continue;
			for (int j = 0; j < 3; j++)
				s[n].rgb[j] = linear[p[j]] / (float)gain[k];
			s[n].grey = 0.2126f * s[n].rgb[0] + 0.7152f * s[n].rgb[1] + 0.0722f * s[n].rgb[2];
			s[n++].weight = (float)p[3] / 255;
		}
		weight[i] = n ? most(rgb, s, n) : 0;
		for (int j = 0; j < 3; j++)
			ln[i][j] = n ? logf(rgb[j]) : 0;
	}
}
