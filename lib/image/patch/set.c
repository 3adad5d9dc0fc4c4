/* Patches as they are cut out of the reference. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/patch/impl.h"
#include "math/simd.h"

/* Two pixels beside each other. */
struct pair {
	float left, right;
};

/* Pairs are fetched one by one, between two loops in vectors: twice as fast as vectors that gather single pixels. */
SIMD_CLONES void patch_sample(float *restrict out, const float *restrict px, int stride, int n, const float *restrict dx,
                              const float *restrict dy, const float m[6])
{
	float cx = m[0], cy = m[1], a = m[2], b = m[3], c = m[4], d = m[5], u[ROOM], v[ROOM];
	struct pair high[ROOM], deep[ROOM];
	int at[ROOM];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float x = cx + a * dx[i] + b * dy[i], y = cy + c * dx[i] + d * dy[i];
		int ix = (int)x, iy = (int)y;
		u[i] = x - (float)ix;
		v[i] = y - (float)iy;
		at[i] = iy * stride + ix;
	}
	for (int i = 0; i < n; i++) {
		memcpy(&high[i], px + at[i], sizeof high[i]);
		memcpy(&deep[i], px + at[i] + stride, sizeof deep[i]);
	}
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float top = high[i].left + u[i] * (high[i].right - high[i].left), low = deep[i].left + u[i] * (deep[i].right - deep[i].left);
		out[i] = top + v[i] * (low - top);
	}
}

bool patch_place(float m[6], const struct scales *p, int level, const struct patch_warp *w, double reach)
{
	const struct scale_level *l = &p->level[level];
	double s = 1.0 / (1 << level);
	double x = (w->at[0] - p->x0) * s - 0.5, y = (w->at[1] - p->y0) * s - 0.5;
	double rx = reach * (fabs(w->A[0][0]) + fabs(w->A[0][1])), ry = reach * (fabs(w->A[1][0]) + fabs(w->A[1][1]));
	if (!(x - rx >= 0 && y - ry >= 0 && x + rx < l->width - 1.001 && y + ry < l->height - 1.001))
		return false;
	const float out[6] = { (float)x, (float)y, (float)w->A[0][0], (float)w->A[0][1], (float)w->A[1][0], (float)w->A[1][1] };
	for (int k = 0; k < 6; k++)
		m[k] = out[k];
	return true;
}

/* Weighted means and products of the derivatives; writes t->rows. T, gx, gy, w: [padded]. */
static void make(struct template *t, const struct patch_set *s, const float *T, const float *gx, const float *gy, const float *w)
{
	int n = s->padded;
	double W = 0, mean = 0, dmean[P] = { 0 }, dT[P] = { 0 };
	for (int i = 0; i < n; i++) {
		W += w[i];
		mean += w[i] * T[i];
	}
	mean /= W;
	t->weight = W;
	for (int i = 0; i < n; i++) {
		float d[P] = { gx[i], gy[i], gx[i] * s->dx[i], gx[i] * s->dy[i], gy[i] * s->dx[i], gy[i] * s->dy[i] };
		t->energy += w[i] * (T[i] - mean) * (T[i] - mean);
		for (int k = 0; k < P; k++) {
			dmean[k] += w[i] * d[k] / W;
			dT[k] += w[i] * d[k] * (T[i] - mean);
			t->rows[k * n + i] = d[k];
		}
		t->rows[P * n + i] = w[i] * (float)(T[i] - mean);
		t->rows[(P + 1) * n + i] = w[i];
	}
	for (int i = 0; i < n; i++) {
		double d[P];
		for (int k = 0; k < P; k++)
			d[k] = t->rows[k * n + i] - dmean[k] - dT[k] / t->energy * (T[i] - mean);
		for (int k = 0; k < P; k++) {
			t->rows[k * n + i] = w[i] * (float)d[k];
			for (int j = 0; j < P; j++)
				t->H[k][j] += w[i] * d[k] * d[j];
		}
	}
}

/* Square of a pixel's distance from the centre over the radius; beyond FAR2 its weight is 0. */
static const double FAR2 = 1.6;
static double share2(double dx, double dy, int radius)
{
	return (dx * dx + dy * dy) / (radius * (radius + 1.0));
}

/* Weights of a patch's pixels: they fall with distance from the centre; pixels of something else have 0. Returns their sum. */
static double weigh(float *w, const struct patch_set *s, const struct scales *p, int level, const double at[2], const float *mask)
{
	double sum = 0;
	const struct scale_level *l = &p->level[0];
	for (int i = 0; i < s->padded; i++) {
		w[i] = i < s->count ? (float)exp(-share2(s->dx[i], s->dy[i], s->conf.radius)) : 0;
		if (mask && w[i] > 0) {
			int x = (int)(at[0] + s->dx[i] * (1 << level)) - p->x0, y = (int)(at[1] + s->dy[i] * (1 << level)) - p->y0;
			w[i] *= x < 0 || y < 0 || x >= l->width || y >= l->height ? 0 : mask[(long)y * l->stride + x];
		}
		sum += w[i];
	}
	return sum;
}

static void take(struct template *t, const struct patch_set *s, const struct scales *p, int level, const double at[2], const float *mask)
{
	float T[ROOM], gx[ROOM], gy[ROOM], w[ROOM], far[ROOM], m[6];
	const struct scale_level *l = &p->level[level];
	struct patch_warp still = { { at[0], at[1] }, { { 1, 0 }, { 0, 1 } } };
	double full = 0.5 * 3.1416 * s->conf.radius * s->conf.radius / s->conf.every;
	if (!patch_place(m, p, level, &still, s->conf.radius + 1) || weigh(w, s, p, level, at, mask) < 0.25 * full)
		return;
	t->rows = mem_array((size_t)(P + 2) * (size_t)s->padded, sizeof *t->rows);
	patch_sample(T, l->px, l->stride, s->padded, s->dx, s->dy, m);
	for (int axis = 0; axis < 2; axis++) {
		float *g = axis ? gy : gx, back[6], on[6];
		for (int k = 0; k < 6; k++)
			back[k] = on[k] = m[k];
		back[axis] -= 1;
		on[axis] += 1;
		patch_sample(far, l->px, l->stride, s->padded, s->dx, s->dy, back);
		patch_sample(g, l->px, l->stride, s->padded, s->dx, s->dy, on);
		for (int i = 0; i < s->padded; i++)
			g[i] = 0.5f * (g[i] - far[i]);
	}
	make(t, s, T, gx, gy, w);
	// a patch whose contrast is below the noise has no texture to align
	t->usable = t->energy > 0.25 * s->conf.noise * s->conf.noise * t->weight && t->H[0][0] > 0 && t->H[1][1] > 0;
}

/* Which pixels a patch has. */
static void lay(struct patch_set *s)
{
	int r = s->conf.radius;
	s->dx = mem_new(ROOM, sizeof *s->dx);
	s->dy = mem_new(ROOM, sizeof *s->dy);
	for (int y = -r; y <= r; y++)
		for (int x = -r; x <= r; x++)
			if ((x + y + 2 * r) % s->conf.every == 0 && share2(x, y, r) < FAR2) {
				s->dx[s->count] = (float)x;
				s->dy[s->count++] = (float)y;
			}
	s->padded = (s->count + LANES - 1) / LANES * LANES;
}

struct patch_set *patch_set_new(const struct scales *p, int n, const double (*at)[2], const float *weight, const struct patch_conf *conf)
{
	struct patch_set *s = mem_new(1, sizeof *s);
	s->conf = *conf;
	s->conf.radius = conf->radius > RADIUS_MAX ? RADIUS_MAX : conf->radius;
	s->n = n;
	lay(s);
	s->template = mem_new((size_t)n * SCALES_LEVELS + 1, sizeof *s->template);
#pragma omp parallel for schedule(dynamic, 8)
	for (int k = 0; k < n * p->levels; k++)
		take(&s->template[(long)(k / p->levels) * SCALES_LEVELS + k % p->levels], s, p, k % p->levels, at[k / p->levels], weight);
	return s;
}

void patch_set_free(struct patch_set *s)
{
	if (!s)
		return;
	for (long k = 0; k < (long)s->n * SCALES_LEVELS; k++)
		free(s->template[k].rows);
	free(s->template);
	free(s->dx);
	free(s->dy);
	free(s);
}
