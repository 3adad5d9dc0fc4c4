/* Grain: what of the skin varies within some millimetres, measured in bands and drawn anew where none is seen. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "math/stats.h"

static const double finest_mm = 0.15, far_radii = 2.3;  // of an eyeball: grain is measured off its lids
static const double cells = 1.7;                        // mm of a cell of the noise in those of its band: their waves are as long

/* Value noise in three dimensions: skin has no seams then, and no stretches. */
static float corner(int x, int y, int z, uint32_t seed)
{
	uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu ^ seed * 0x9e3779b9u;
	h = (h ^ h >> 15) * 0x2c1b3c6du;
	h = (h ^ h >> 12) * 0x297a2d39u;
	h ^= h >> 15;
	return (float)(h & 0xffff) / 32767.5f - 1;
}

static float noise(const float x[3], double per_mm, uint32_t seed)
{
	float f[3], sum = 0;
	int i[3];
	for (int c = 0; c < 3; c++) {
		const double at = (double)x[c] * per_mm;
		i[c] = (int)floor(at);
		const float t = (float)(at - i[c]);
		f[c] = t * t * (3 - 2 * t);
	}
	for (int k = 0; k < 8; k++)
		sum += (k & 1 ? f[0] : 1 - f[0]) * (k & 2 ? f[1] : 1 - f[1]) * (k & 4 ? f[2] : 1 - f[2]) * corner(i[0] + (k & 1), i[1] + (k >> 1 & 1), i[2] + (k >> 2), seed);
	return sum;
}

// Its standard deviation: a corner's, sqrt(1/3), by the mean of (w^2 + (1 - w)^2) over a cell, 26/35, for each of three directions.
static const double noise_rms = 0.5773502691896258 * 0.6402;

static bool off_lids(const struct complexion *c, long i)
{
	float x[3];
	if (!complexion_place(x, c, i))
		return false;
	for (int s = 0; s < 2; s++)
		if (hypot((double)x[0] - c->eye[s][0], (double)x[1] - c->eye[s][1]) < far_radii * c->radius)
			return false;
	return true;
}

/* The quantiles of grain over its rms, and how colours go with luminance. d: [side][side][3] ln; use: texels. */
static bool shape_of(struct complexion_grain *g, const float (*d)[3], const bool *use, long n)
{
	enum { MOST = 200000, LEAST = 4000 };
	double *x = mem_array(MOST + 1, sizeof *x), with[3] = { 0 }, all = 1e-12;
	long many = 0;
	int kept = 0;
	for (long i = 0; i < n; i++)
		many += use[i];
	const long step = many / MOST + 1;
	for (long i = 0, k = 0; i < n; i++) {
		if (!use[i] || k++ % step || kept == MOST)
			continue;
		const double grey = complexion_luminance(d[i]);
		x[kept++] = grey;
		all += grey * grey;
		for (int c = 0; c < 3; c++)
			with[c] += grey * (double)d[i][c];
	}
	g->all = sqrt(all / fmax(kept, 1));
	for (int c = 0; c < 3; c++)
		g->slope[c] = with[c] / all;
	for (int q = 0; q < QUANTILES && kept >= LEAST; q++)
		g->quantile[q] = stats_quantile(kept, x, fmin(fmax((double)q / (QUANTILES - 1), 0.002), 0.998)) / g->all;
	free(x);
	return kept >= LEAST;
}

/* Weight of a texel that is seen, in the mean, at most 1: of one view alone it is less. */
static float usual_weight(const float *weight, long n)
{
	double sum = 0;
	long seen = 0;
	for (long i = 0; i < n; i++) {
		sum += (double)weight[i];
		seen += weight[i] > 0;
	}
	return seen ? (float)fmin(sum / (double)seen, 1) : 1;
}

bool complexion_grain_measure(struct complexion_grain *g, const float (*ln)[3], const float *weight, const struct complexion *c, struct err *err)
{
	const long n = (long)c->side * c->side;
	const float usual = usual_weight(weight, n);
	float (*d)[3] = mem_array((size_t)n + 1, sizeof *d), *fine = mem_array((size_t)n + 1, sizeof *fine), *coarse = mem_array((size_t)n + 1, sizeof *coarse);
	float *sum = mem_array((size_t)n + 1, sizeof *sum);
	bool *use = mem_new((size_t)n + 1, sizeof *use), ok = true;
	*g = (struct complexion_grain){ 0 };
	for (long i = 0; i < n; i++)
		fine[i] = (float)complexion_luminance(ln[i]);
	ok = complexion_blur(&d[0][0], sum, &ln[0][0], weight, 3, finest_mm * (1 << BANDS), c, err);
	for (long i = 0; i < n; i++) {
		use[i] = weight[i] > 0 && sum[i] > 0.5f * usual && off_lids(c, i);
		for (int k = 0; k < 3; k++)
			d[i][k] = ln[i][k] - d[i][k];
	}
	for (int b = 0; b < BANDS && ok; b++) {
		double all = 0, many = 1e-9;
		g->mm[b] = finest_mm * (1 << b);
		ok = complexion_blur(coarse, 0, fine, weight, 1, g->mm[b] * 1.414, c, err);
		for (long i = 0; i < n && ok; i++) {
			if (use[i]) {
				all += ((double)fine[i] - (double)coarse[i]) * ((double)fine[i] - (double)coarse[i]);
				many++;
			}
			fine[i] = coarse[i];
		}
		g->rms[b] = sqrt(all / many);
	}
	if (ok && !shape_of(g, (const float(*)[3])d, use, n))
		ok = err_set(err, "no skin off the lids shows its grain");
	free(d);
	free(fine);
	free(coarse);
	free(sum);
	free(use);
	return ok;
}

double complexion_grain_at(const struct complexion_grain *g, const float x[3], double texel)
{
	double sum = 0, all = 1e-12;
	for (int b = 0; b < BANDS; b++) {
		const double cell = cells * g->mm[b], shows = fmin(fmax(2 - texel / (0.6 * cell), 0), 1);  // not what is finer than texels
		if (shows > 0 && g->rms[b] > 0)
			sum += shows * g->rms[b] / noise_rms * (double)noise(x, 1 / cell, (uint32_t)b + 1);
		all += g->rms[b] * g->rms[b];
	}
	// A normal variate's rank, and what of the skin seen has that rank.
	const double z = sum / sqrt(all), rank = (QUANTILES - 1) * 0.5 * erfc(-z * M_SQRT1_2);
	const int k = (int)fmin(fmax(rank, 0), QUANTILES - 2);
	return g->all * (g->quantile[k] + (rank - k) * (g->quantile[k + 1] - g->quantile[k]));
}
