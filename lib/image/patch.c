#include "image/patch.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/simd.h"

enum { P = 6, LANES = 16 };  // x, y, and A row by row

/* One patch at one level. */
struct template {
	bool usable;
	float *rows;        // [P + 2][padded]: weighted derivatives less template and constant; weighted template less its mean; weight
	double H[P][P];     // of the derivatives
	double weight, energy;  // sum of the weights; of weight (T - mean)^2
};

struct patch_set {
	struct patch_conf conf;
	int n, side, count, padded;
	float *dx, *dy;     // [padded] px from the centre
	struct template *template;  // [n][SCALES_LEVELS]
};

/* One scratch row per thread lives on its stack: patches are small. */
enum { RADIUS_MAX = 24, ROOM = (2 * RADIUS_MAX + 1) * (2 * RADIUS_MAX + 1) + LANES };

SIMD_CLONES static void sample(float *restrict out, const float *restrict px, int stride, int n, const float *restrict dx,
                               const float *restrict dy, const float m[6])
{
	float cx = m[0], cy = m[1], a = m[2], b = m[3], c = m[4], d = m[5];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float x = cx + a * dx[i] + b * dy[i], y = cy + c * dx[i] + d * dy[i];
		int ix = (int)x, iy = (int)y;
		float u = x - (float)ix, v = y - (float)iy;
		int k = iy * stride + ix;
		float top = px[k] + u * (px[k + 1] - px[k]), low = px[k + stride] + u * (px[k + stride + 1] - px[k + stride]);
		out[i] = top + v * (low - top);
	}
}

/* Sums over i of rows[r][i] I[i], and of w I, w I^2. Lanes are summed in a fixed order: the bits do not depend on the
 * width of the machine's vectors. */
SIMD_CLONES static void sums(float out[P + 3], const float *restrict rows, const float *restrict in, int n)
{
	float lane[P + 3][LANES] = { { 0 } };
	for (int i = 0; i < n; i += LANES) {
		for (int r = 0; r < P + 2; r++) {
			SIMD_LOOP
			for (int j = 0; j < LANES; j++)
				lane[r][j] += rows[r * n + i + j] * in[i + j];
		}
		SIMD_LOOP
		for (int j = 0; j < LANES; j++)
			lane[P + 2][j] += rows[(P + 1) * n + i + j] * in[i + j] * in[i + j];
	}
	for (int r = 0; r < P + 3; r++) {
		out[r] = 0;
		for (int j = 0; j < LANES; j++)
			out[r] += lane[r][j];
	}
}

/* Place of the warp in index coordinates of a level; false when a corner is outside. */
static bool place(float m[6], const struct scales *p, int level, const struct patch_warp *w, double reach)
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

/* Weights of a patch's pixels: nearer ones count more; those of something else not. Returns their sum. */
static double weigh(float *w, const struct patch_set *s, const struct scales *p, int level, const double at[2], const float *mask)
{
	double sum = 0;
	const struct scale_level *l = &p->level[0];
	for (int i = 0; i < s->padded; i++) {
		double r2 = (s->dx[i] * s->dx[i] + s->dy[i] * s->dy[i]) / (s->conf.radius * (s->conf.radius + 1.0));
		w[i] = i < s->count && r2 < 1.6 ? (float)exp(-r2) : 0;
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
	double full = 0.5 * 3.1416 * s->conf.radius * s->conf.radius;
	if (!place(m, p, level, &still, s->conf.radius + 1) || weigh(w, s, p, level, at, mask) < 0.25 * full)
		return;
	t->rows = mem_array((size_t)(P + 2) * (size_t)s->padded, sizeof *t->rows);
	sample(T, l->px, l->stride, s->padded, s->dx, s->dy, m);
	for (int axis = 0; axis < 2; axis++) {
		float *g = axis ? gy : gx, back[6], on[6];
		for (int k = 0; k < 6; k++)
			back[k] = on[k] = m[k];
		back[axis] -= 1;
		on[axis] += 1;
		sample(far, l->px, l->stride, s->padded, s->dx, s->dy, back);
		sample(g, l->px, l->stride, s->padded, s->dx, s->dy, on);
		for (int i = 0; i < s->padded; i++)
			g[i] = 0.5f * (g[i] - far[i]);
	}
	make(t, s, T, gx, gy, w);
	// a plain patch tells nothing: its contrast is below that of the noise
	t->usable = t->energy > 0.25 * s->conf.noise * s->conf.noise * t->weight && t->H[0][0] > 0 && t->H[1][1] > 0;
}

struct patch_set *patch_set_new(const struct scales *p, int n, const double (*at)[2], const float *weight, const struct patch_conf *conf)
{
	struct patch_set *s = mem_new(1, sizeof *s);
	s->conf = *conf;
	s->conf.radius = conf->radius > RADIUS_MAX ? RADIUS_MAX : conf->radius;
	s->n = n;
	s->side = 2 * s->conf.radius + 1;
	s->count = s->side * s->side;
	s->padded = (s->count + LANES - 1) / LANES * LANES;
	s->dx = mem_new((size_t)s->padded, sizeof *s->dx);
	s->dy = mem_new((size_t)s->padded, sizeof *s->dy);
	for (int i = 0; i < s->count; i++) {
		s->dx[i] = (float)(i % s->side - s->conf.radius);
		s->dy[i] = (float)(i / s->side - s->conf.radius);
	}
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

bool patch_usable(const struct patch_set *s, int i, int level)
{
	return s->template[(long)i * SCALES_LEVELS + level].usable;
}

/* Correlation, gain and the mean square that they leave from the sums; false when the picture is plain there. */
static bool compare(double *ncc, double *gain, double *left, const struct template *t, const float sum[P + 3])
{
	double mean = sum[P + 1] / t->weight, energy = sum[P + 2] - mean * sum[P + 1];
	*gain = sum[P] / t->energy;
	*ncc = energy > 1e-3 * t->weight ? sum[P] / sqrt(energy * t->energy) : 0;
	*left = (energy - *gain * sum[P]) / t->weight;
	return *ncc > 0 && *gain > 0.05;
}

bool patch_look(struct patch_fit *fit, const struct patch_set *s, int i, int level, const struct scales *p, const struct patch_warp *warp)
{
	const struct template *t = &s->template[(long)i * SCALES_LEVELS + level];
	float in[ROOM], m[6], sum[P + 3];
	double gain, left;
	*fit = (struct patch_fit){ 0 };
	if (!t->usable || level >= p->levels || !place(m, p, level, warp, s->conf.radius + 0.5))
		return false;
	sample(in, p->level[level].px, p->level[level].stride, s->padded, s->dx, s->dy, m);
	sums(sum, t->rows, in, s->padded);
	compare(&fit->ncc, &gain, &left, t, sum);
	return true;
}

/* Adds the prior to the normal equations: where the warp would go per parameter, d(at) = -A d(t), d(A) = -A dA. */
static void add_prior(double H[P][P], double g[P], const struct patch_warp *w, const struct patch_prior *prior, double scale, double noise2)
{
	double pt = noise2 * scale * scale / (prior->at_sigma * prior->at_sigma), pa = noise2 / (prior->A_sigma * prior->A_sigma);
	double AtA[2][2], to[2], tA[2][2];
	for (int r = 0; r < 2; r++) {
		double e[2] = { w->at[0] - prior->mean.at[0], w->at[1] - prior->mean.at[1] };
		to[r] = (w->A[0][r] * e[0] + w->A[1][r] * e[1]) / scale;
		for (int c = 0; c < 2; c++) {
			AtA[r][c] = w->A[0][r] * w->A[0][c] + w->A[1][r] * w->A[1][c];
			tA[r][c] = w->A[0][r] * (w->A[0][c] - prior->mean.A[0][c]) + w->A[1][r] * (w->A[1][c] - prior->mean.A[1][c]);
		}
	}
	for (int r = 0; r < 2; r++) {
		g[r] += pt * to[r];
		for (int c = 0; c < 2; c++) {
			H[r][c] += pt * AtA[r][c];
			g[2 + 2 * r + c] += pa * tA[r][c];
			for (int k = 0; k < 2; k++)
				H[2 + 2 * r + k][2 + 2 * c + k] += pa * AtA[r][c];
		}
	}
}

/* warp after the inverse of the step (t, A) has been put before it. False when it degenerates. */
static bool compose(struct patch_warp *w, const double d[P], double scale)
{
	double a = 1 + d[2], b = d[3], c = d[4], e = 1 + d[5], det = a * e - b * c;
	if (!(det > 0.25 && det < 4))
		return false;
	double inv[2][2] = { { e / det, -b / det }, { -c / det, a / det } }, A[2][2];
	for (int r = 0; r < 2; r++)
		for (int k = 0; k < 2; k++)
			A[r][k] = w->A[r][0] * inv[0][k] + w->A[r][1] * inv[1][k];
	double area = A[0][0] * A[1][1] - A[0][1] * A[1][0];
	if (!(area > 0.05 && area < 6))
		return false;
	for (int r = 0; r < 2; r++) {
		w->at[r] -= scale * (A[r][0] * d[0] + A[r][1] * d[1]);
		for (int k = 0; k < 2; k++)
			w->A[r][k] = A[r][k];
	}
	return true;
}

bool patch_align(struct patch_warp *warp, struct patch_fit *fit, const struct patch_set *s, int i, int level, const struct scales *p,
                 const struct patch_prior *prior)
{
	const struct template *t = &s->template[(long)i * SCALES_LEVELS + level];
	const struct scale_level *l = &p->level[level];
	float in[ROOM], m[6], sum[P + 3];
	struct patch_warp w = *warp;
	double scale = 1 << level, noise2 = s->conf.noise * s->conf.noise, gain, left;
	*fit = (struct patch_fit){ 0 };
	if (!t->usable || level >= p->levels)
		return false;
	for (int it = 0; it < s->conf.iterations; it++) {
		if (!place(m, p, level, &w, s->conf.radius + 0.5))
			return false;
		sample(in, l->px, l->stride, s->padded, s->dx, s->dy, m);
		sums(sum, t->rows, in, s->padded);
		if (!compare(&fit->ncc, &gain, &left, t, sum))
			gain = fmax(gain, 0.3);
		// what does not fit is no noise: neighbouring pixels err together
		noise2 = s->conf.noise * s->conf.noise + s->conf.misfit * fmax(0, left) / (gain * gain);
		double H[P][P], g[P];
		for (int r = 0; r < P; r++) {
			g[r] = sum[r] / gain;
			for (int c = 0; c < P; c++)
				H[r][c] = t->H[r][c];
			H[r][r] += 1e-6 * t->H[r][r] + 1e-9;
		}
		if (prior)
			add_prior(H, g, &w, prior, scale, noise2);
		if (!chol_solve(P, P, &H[0][0], g) || !compose(&w, g, scale))
			return false;
		fit->step = scale * hypot(g[0], g[1]);
		fit->iterations++;
		if (fit->step < s->conf.stop * scale)
			break;
	}
	double det = t->H[0][0] * t->H[1][1] - t->H[0][1] * t->H[1][0];
	fit->sigma = scale * sqrt(noise2) * sqrt((t->H[0][0] + t->H[1][1]) / fmax(det, 1e-9));
	*warp = w;
	return true;
}
