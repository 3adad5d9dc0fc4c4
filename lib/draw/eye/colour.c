#include "draw/eye/colour.h"

#include <math.h>

#include "draw/eye/march/march.h"
#include "draw/eye/own_light.h"
#include "draw/eye/tint.h"
#include "optics/lightpath/lightpath.h"

/* A texel brightens much only where the model had it in shadow: at most so much, and its channels so far from their mean. */
SIMD_CLONES static void ratio_whole(int n, float *restrict r, float *restrict g, float *restrict b, const float *const per_model[3], float most, float chroma)
{
	const float *restrict per_r = per_model[0], *restrict per_g = per_model[1], *restrict per_b = per_model[2];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		// A few wavelengths stand for the spectrum: deep in dark tissue their sum may fall below zero.
		float x = (r[i] > 0 ? r[i] : 0) * per_r[i], y = (g[i] > 0 ? g[i] : 0) * per_g[i], z = (b[i] > 0 ? b[i] : 0) * per_b[i], mean = (x + y + z) * (1 / 3.0f);
		float lit = mean < most ? mean : most, low = lit * (1 / chroma), high = lit * chroma, k = mean > 1e-6f ? lit / mean : 1;
		x *= k;
		y *= k;
		z *= k;
		r[i] = x > low ? x < high ? x : high : low;
		g[i] = y > low ? y < high ? y : high : low;
		b[i] = z > low ? z < high ? z : high : low;
	}
}

void scene_colour_ratio(int n, float rgb[3][BATCH], const struct scene *s, const float *const per_model[3])
{
	float d = (float)s->conf.detail, alone[3][BATCH];
	for (int c = 0; c < 3 && d < 1; c++)
		for (int i = 0; i < n; i++)
			alone[c][i] = s->gain * rgb[c][i];
	ratio_whole(n, rgb[0], rgb[1], rgb[2], per_model, (float)s->conf.ratio_most, (float)s->conf.ratio_chroma);
	for (int c = 0; c < 3 && d < 1; c++)
		for (int i = 0; i < n; i++)
			rgb[c][i] = alone[c][i] > 0 && rgb[c][i] > 0 ? powf(rgb[c][i], d) * powf(alone[c][i], 1 - d) : 0;
}

void scene_colour(float rgb[3], const struct scene *s, const struct scene_level *level, float x, float y, float own)
{
	float per[3], ratio[3][BATCH], tint[3] = { 1, 1, 1 }, d = (float)s->conf.detail;
	if (!level->model)
		return;
	for (int c = 0; c < 3; c++) {
		per[c] = 1 / channel_at(level->model, level->n, level->per_mm, x, y, 4, c);
		ratio[c][0] = rgb[c];
	}
	if (d < 1)
		scene_tint_at(tint, s, x, y);
	own = scene_own_light_at(s, own, x, y);
	scene_colour_ratio(1, ratio, s, (const float *const[3]){ &per[0], &per[1], &per[2] });
	for (int c = 0; c < 3; c++) {
		float shown = channel_at(level->colour, level->n, level->per_mm, x, y, 4, c);
		rgb[c] = own * ratio[c][0] * (d == 1 ? shown : shown > 0 ? powf(shown, d) * powf(tint[c], 1 - d) : 0);
	}
}

void scene_model_row(struct iris_batch *b, const struct scene *s, const struct scene_level *level, int x0, int n, int y,
                     const double C[3], const struct scene_beams *beams)
{
	float k[3][BATCH], gx, gy;
	b->n = n;
	for (int i = 0; i < n; i++) {
		b->px[i] = ((float)(x0 + i) + 0.5f) / level->per_mm - (float)s->extent;
		b->py[i] = ((float)y + 0.5f) / level->per_mm - (float)s->extent;
		b->pz[i] = (float)s->eye.iris_depth
		           - relief_at(level->relief, level->n, level->per_mm, b->px[i], b->py[i], &gx, &gy);
	}
	lightpath_batch_point(n, b->px, b->py, b->pz, C, k[0], k[1], k[2], 0, &s->cornea, 4);
	for (int i = 0; i < n; i++) {
		float d[3] = { b->px[i] - k[0][i], b->py[i] - k[1][i], b->pz[i] - k[2][i] };
		float len = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		bool good = len > 0.1f && d[2] > 0.2f * len;  // else straight down: nobody sees it
		b->vx[i] = good ? d[0] / len : 0;
		b->vy[i] = good ? d[1] / len : 0;
		b->vz[i] = good ? d[2] / len : 1;
	}
	scene_scatter(b, s, level, beams);
}
