#include "draw/eye/own_light.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/eye/batch_impl.h"
#include "draw/eye/colour.h"
#include "draw/eye/tint.h"

enum { NODES = 128 };  // across the map
static const double most_ln = 1.5;  // of own_light

static float luminance(const float rgb[3])
{
	return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

/* Photograph over model of a texel; false where the photograph did not see the iris, or the model knows no light there. */
static bool ratio_at(float ratio[3], const struct scene *s, int x, int y)
{
	const struct scene_level *l = &s->level[0];
	const float *seen = l->colour + 4 * ((long)y * l->n + x), *model = l->model + 4 * ((long)y * l->n + x), least = 10 * SCENE_DARK;
	double u = (x + 0.5) / l->per_mm - s->extent, v = (y + 0.5) / l->per_mm - s->extent;
	if (seen[3] < 0.5f || hypot(u - s->pupil[0], v - s->pupil[1]) < s->pupil[2] + 0.1 || hypot(u, v) > 0.97 * s->limbus[0])
		return false;
	float tint[3];
	scene_tint_at(tint, s, (float)u, (float)v);
	for (int c = 0; c < 3; c++) {
		if (!(model[c] > least))
			return false;
		ratio[c] = seen[c] / (s->gain * tint[c] * model[c]);
	}
	return true;
}

/* Mean ln luminance of the ratio over each node's texels, times their number, and that number. */
static void gather(float *node, const struct scene *s, int nodes)
{
	int n = s->level[0].n;
#pragma omp parallel for schedule(static)
	for (int j = 0; j < nodes; j++)
		for (int i = 0; i < nodes; i++) {
			float *to = node + 2 * (j * nodes + i), ratio[3];
			to[0] = to[1] = 0;
			for (int y = j * n / nodes; y < (j + 1) * n / nodes; y++)
				for (int x = i * n / nodes; x < (i + 1) * n / nodes; x++)
					if (ratio_at(ratio, s, x, y)) {
						to[0] += logf(luminance(ratio));
						to[1]++;
					}
		}
}

/* Takes the mean of each radius about the pupil out of own_light, linear between rings. node: its texels, as gathered and blurred. */
static void keep_rings(struct scene *s, const float *node)
{
	enum { RINGS = 64 };
	double sum[RINGS + 1] = { 0 }, all[RINGS + 1] = { 0 };
	int n = s->own_light.width;
	for (int turn = 0; turn < 2; turn++)
		for (int i = 0; i < n * n; i++) {
			double x = (2 * (i % n + 0.5) / n - 1) * s->extent - s->pupil[0], y = (2 * (i / n + 0.5) / n - 1) * s->extent - s->pupil[1];
			double at = hypot(x, y) / s->extent * RINGS / 1.5, weight = node[2 * i + 1];
			int k = at < RINGS - 1 ? (int)at : RINGS - 1;
			double t = fmin(at - k, 1);
			if (!turn) {
				sum[k] += (1 - t) * weight * (double)s->own_light.px[i];
				sum[k + 1] += t * weight * (double)s->own_light.px[i];
				all[k] += (1 - t) * weight;
				all[k + 1] += t * weight;
			} else if (weight > 1e-3) {
				s->own_light.px[i] -= (float)((1 - t) * (all[k] > 0 ? sum[k] / all[k] : 0) + t * (all[k + 1] > 0 ? sum[k + 1] / all[k + 1] : 0));
			}
		}
}

static float own_at(const struct scene *s, float x, float y)
{
	return channel_at(s->own_light.px, s->own_light.width, (float)(s->own_light.width / (2 * s->extent)), x, y, 1, 0);
}

/* Takes own_light out of the photograph's colours, and bounds what is left of their ratio to the model. */
static void take(struct scene *s)
{
	struct scene_level *l = &s->level[0];
	const float most = (float)s->conf.albedo_most;
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < l->n; y++)
		for (int x = 0; x < l->n; x++) {
			float *to = l->colour + 4 * ((long)y * l->n + x), ratio[3], own, keep = 1;
			own = expf(-own_at(s, ((float)x + 0.5f) / l->per_mm - (float)s->extent, ((float)y + 0.5f) / l->per_mm - (float)s->extent));
			if (ratio_at(ratio, s, x, y)) {
				float albedo = own * luminance(ratio);
				keep = fminf(fmaxf(albedo, 1 / most), most) / albedo;
			}
			for (int c = 0; c < 3; c++)
				to[c] = fmaxf(keep * own * to[c], SCENE_DARK);
		}
}

void scene_own_light_make(struct scene *s, const struct scene_beams *beams)
{
	if (!(s->conf.albedo_mm > 0))
		return;
	int n = s->level[0].n, nodes = n < NODES ? n : NODES;
	float *node = mem_array((size_t)nodes * (size_t)nodes, 2 * sizeof *node);
	struct err err = { 0 };
	image_free(&s->own_light);
	gather(node, s, nodes);
	if (cv_blur(node, node, nodes, nodes, 2, s->conf.albedo_mm * nodes / (2 * s->extent), &err)) {
		s->own_light = image_new(nodes, nodes, 1);
		for (int i = 0; i < nodes * nodes; i++)
			s->own_light.px[i] = node[2 * i + 1] > 1e-3f ? (float)fmin(fmax(node[2 * i] / node[2 * i + 1], -most_ln), most_ln) : 0;
		keep_rings(s, node);
		for (int c = 0; c < 3; c++)
			s->own_mean[c] = beams->mean[c];
		take(s);
	}
	free(node);
}

float scene_own_light_share(const struct scene *s, const float mean[3])
{
	float off = 0, width = (float)s->conf.own_width;
	if (!s->own_light.px)
		return 0;
	for (int c = 0; c < 3; c++)
		off += (mean[c] - s->own_mean[c]) * (mean[c] - s->own_mean[c]);
	return expf(-0.5f * off / (width * width));
}

float scene_own_light_at(const struct scene *s, float share, float x, float y)
{
	float power = share * (float)s->conf.detail;
	return power > 1e-4f ? expf(power * own_at(s, x, y)) : 1;
}
