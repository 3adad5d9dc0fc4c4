#include "image/patch/patch.h"

#include <math.h>

#include "image/patch/impl.h"
#include "math/chol.h"
#include "math/simd.h"

/* Sums over i of rows[r][i] I[i], and of w I, w I^2. Lanes are summed in a fixed order, so that the bits do not depend on
 * the width of the machine's vectors. */
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

/* Correlation, gain and mean square of the residual, from the sums; false where the picture has no contrast. */
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
	if (!t->usable || level >= p->levels || !patch_place(m, p, level, warp, s->conf.radius + 0.5))
		return false;
	patch_sample(in, p->level[level].px, p->level[level].stride, s->padded, s->dx, s->dy, m);
	sums(sum, t->rows, in, s->padded);
	compare(&fit->ncc, &gain, &left, t, sum);
	return true;
}

/* Adds the prior to the normal equations. Derivatives of the warp by the parameters: d(at) = -A d(t), d(A) = -A dA. */
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

/* Composes the warp with the inverse of the step (t, A). False when it degenerates. */
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
		if (!patch_place(m, p, level, &w, s->conf.radius + 0.5))
			return false;
		patch_sample(in, l->px, l->stride, s->padded, s->dx, s->dy, m);
		sums(sum, t->rows, in, s->padded);
		if (!compare(&fit->ncc, &gain, &left, t, sum))
			gain = fmax(gain, 0.3);
		// a misfit is no white noise: residuals of neighbouring pixels are correlated
		noise2 = s->conf.noise * s->conf.noise + s->conf.misfit / s->conf.every * fmax(0, left) / (gain * gain);
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
