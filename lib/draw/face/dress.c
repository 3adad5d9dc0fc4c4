#include "draw/face/dress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "character/texture.h"
#include "image/image.h"

enum { LEVELS = 15 };

/* A texture and its halves; level 0 is the finest. */
struct texels {
	int n;
	int width[LEVELS], height[LEVELS];
	uint8_t *px[LEVELS];       // [height][width][4]
};

struct dress {
	const struct look *look;
	struct texels *texture;    // [look.n_textures]; n = 0: not needed or damaged
	float linear[256], plain[256];  // of a byte: of sRGB, and 0..1
};

/* Colours are halved as light, weighted by their cover; other maps as they are. */
static void halve(struct texels *t, const struct dress *d, bool colour)
{
	const int k = t->n, w = t->width[k - 1], h = t->height[k - 1], half_w = w > 1 ? w / 2 : 1, half_h = h > 1 ? h / 2 : 1;
	uint8_t *to = mem_array(4 * (size_t)half_w * (size_t)half_h, 1);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < half_h; y++)
		for (int x = 0; x < half_w; x++) {
			float sum[4] = { 0 }, cover = 0;
			for (int j = 0; j < 4; j++) {
				const int u = 2 * x + j % 2 < w ? 2 * x + j % 2 : w - 1, v = 2 * y + j / 2 < h ? 2 * y + j / 2 : h - 1;
				const uint8_t *p = t->px[k - 1] + 4 * ((size_t)v * (size_t)w + (size_t)u);
				const float a = colour ? (float)p[3] + 0.01f : 1;
				for (int c = 0; c < 3; c++)
					sum[c] += a * (colour ? d->linear[p[c]] : (float)p[c]);
				sum[3] += (float)p[3];
				cover += a;
			}
			uint8_t *out = to + 4 * ((size_t)y * (size_t)half_w + (size_t)x);
			for (int c = 0; c < 3; c++)
				out[c] = (uint8_t)lrintf(colour ? 255 * srgb_from_linear(sum[c] / cover) : sum[c] / cover);
			out[3] = (uint8_t)lrintf(sum[3] / 4);
		}
	t->px[k] = to;
	t->width[k] = half_w;
	t->height[k] = half_h;
	t->n++;
}

static void ready(struct dress *d, int i, int longest, bool colour, struct err *why)
{
	struct texels *t = i >= 0 ? &d->texture[i] : 0;
	if (!t || t->n)
		return;
	t->px[0] = look_texture_pixels(&t->width[0], &t->height[0], &d->look->texture[i], longest, why);
	t->n = t->px[0] != 0;
	while (t->n && t->n < LEVELS && (t->width[t->n - 1] > 1 || t->height[t->n - 1] > 1))
		halve(t, d, colour);
}

struct dress *dress_new(const struct look *look, int longest, struct err *why)
{
	struct dress *d = mem_new(1, sizeof *d);
	bool *used = mem_new((size_t)look->n_materials + 1, sizeof *used);
	d->look = look;
	d->texture = mem_new((size_t)look->n_textures + 1, sizeof *d->texture);
	for (int i = 0; i < 256; i++) {
		d->plain[i] = (float)i / 255;
		d->linear[i] = linear_from_srgb(d->plain[i]);
	}
	for (int f = 0; f < look->n_faces; f++)
		if (look->face_material[f] >= 0)
			used[look->face_material[f]] = true;
	for (int i = 0; i < look->n_materials; i++)
		for (int k = LOOK_COLOUR; used[i] && k <= LOOK_ROUGH; k++)
			ready(d, look->material[i].map[k], longest, k == LOOK_COLOUR, why);
	free(used);
	return d;
}

void dress_free(struct dress *d)
{
	if (!d)
		return;
	for (int i = 0; i < d->look->n_textures; i++)
		for (int k = 0; k < d->texture[i].n; k++)
			free(d->texture[i].px[k]);
	free(d->texture);
	free(d);
}

const struct look *dress_look(const struct dress *d)
{
	return d->look;
}

/* Bilinear on one level, repeated in both directions. rgb, cover: of a byte. */
static void texel(float out[4], const struct texels *t, int k, const float uv[2], const float rgb[256], const float cover[256])
{
	const int w = t->width[k], h = t->height[k];
	const float x = (uv[0] - floorf(uv[0])) * (float)w - 0.5f, y = (uv[1] - floorf(uv[1])) * (float)h - 0.5f;
	const int x0 = (int)floorf(x), y0 = (int)floorf(y);  // -1 to w - 1, h - 1
	const int column[2] = { x0 < 0 ? x0 + w : x0, x0 + 1 < w ? x0 + 1 : x0 + 1 - w }, row[2] = { y0 < 0 ? y0 + h : y0, y0 + 1 < h ? y0 + 1 : y0 + 1 - h };
	const float wx[2] = { 1 - x + (float)x0, x - (float)x0 }, wy[2] = { 1 - y + (float)y0, y - (float)y0 };
	memset(out, 0, 4 * sizeof *out);
	for (int j = 0; j < 4; j++) {
		const uint8_t *p = t->px[k] + 4 * ((size_t)row[j / 2] * (size_t)w + (size_t)column[j % 2]);
		const float share = wx[j % 2] * wy[j / 2];
		for (int c = 0; c < 3; c++)
			out[c] += share * rgb[p[c]];
		out[3] += share * cover[p[3]];
	}
}

/* Between two levels, by the width of what is looked at. False: there is no such texture. */
static bool look_up(float out[4], const struct dress *d, int i, const float uv[2], float wide, bool colour)
{
	const struct texels *t = i >= 0 ? &d->texture[i] : 0;
	float fine[4], coarse[4];
	if (!t || !t->n)
		return false;
	const float level = fminf(fmaxf(log2f(fmaxf(wide * (float)t->width[0], 1e-6f)), 0), (float)(t->n - 1));
	const int k = (int)level, next = k + 1 < t->n ? k + 1 : k;
	texel(fine, t, k, uv, colour ? d->linear : d->plain, d->plain);
	texel(coarse, t, next, uv, colour ? d->linear : d->plain, d->plain);
	for (int c = 0; c < 4; c++)
		out[c] = fine[c] + (level - (float)k) * (coarse[c] - fine[c]);
	return true;
}

void dress_at(struct dress_point *out, const struct dress *d, int material, const float uv[2], float wide)
{
	float x[4];
	*out = (struct dress_point){ .rgb = { 1, 1, 1 }, .alpha = 1, .tilt = { 0, 0, 1 }, .rough = 0.6f };
	if (material < 0)
		return;
	const struct look_material *m = &d->look->material[material];
	for (int c = 0; c < 3; c++)
		out->rgb[c] = (float)m->rgba[c];
	out->alpha = (float)m->rgba[3];
	out->rough = (float)m->rough;
	if (look_up(x, d, m->map[LOOK_COLOUR], uv, wide, true)) {
		for (int c = 0; c < 3; c++)
			out->rgb[c] *= x[c];
		out->alpha *= x[3];
	}
	if (look_up(x, d, m->map[LOOK_ROUGH], uv, wide, false))
		out->rough *= x[1];
	if (look_up(x, d, m->map[LOOK_NORMAL], uv, wide, false)) {
		out->bumpy = true;
		for (int c = 0; c < 3; c++)
			out->tilt[c] = (2 * x[c] - 1) * (c < 2 ? (float)m->normal_scale : 1);
	}
	out->alpha = m->alpha == LOOK_OPAQUE ? 1 : (float)(out->alpha >= (m->alpha == LOOK_MASK ? (float)m->cutoff : 0.5f));
}

bool dress_cuts(const struct dress *d, int material)
{
	return material >= 0 && d->look->material[material].alpha != LOOK_OPAQUE;
}
