/* A portrait's picture: the colours of its samples, filtered to pixels. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/face/impl.h"

/* A picture on its way. */
struct canvas {
	struct portrait *p;
	const struct portrait_spot *spots;
	struct portrait_veils veils;
	struct portrait_rays rays;
	struct portrait_sky sky;
	struct portrait_glow glow;
	struct image eye[2];
	int eye_at[2][2], samples;
	unsigned char *hairy;  // [height][width]: 1: a pixel with a hair in it or beside it, 2: one a pixel further off
	long *fine_at;         // [height][width]: of such a pixel's samples in fine
	float (*fine)[4];
};

static void colour_at(float rgba[4], const struct canvas *c, double x, double y, struct portrait_spot spot)
{
	int face = spot.face;
	rgba[0] = rgba[1] = rgba[2] = rgba[3] = 0;
	if (face >= 0) {
		float dir[3];
		portrait_ray(dir, &c->rays, x, y);
		float light[3];
		portrait_shade(rgba, c->p, &c->sky, face, c->rays.origin, dir, portrait_glow_at(light, &c->glow, x, y, spot.depth) ? light : 0);
		rgba[3] = 1;
	} else if (face < -1) {
		const struct image *eye = &c->eye[-2 - face];
		int u = (int)x - c->eye_at[-2 - face][0], v = (int)y - c->eye_at[-2 - face][1];
		const float *px = image_at(eye, u, v);
		float k = px[3] > 0 ? 1 / px[3] : 0;  // the eye's own edge is the skin's to draw
		for (int i = 0; i < 3; i++)
			rgba[i] = px[i] * k;
		rgba[3] = 1;
	}
}

/* Whether three samples in a row are far from collinear in depth: one edge of skin occludes another. */
static bool steps(const struct portrait_spot *a, const struct portrait_spot *b, const struct portrait_spot *c, float apart)
{
	return fabsf(a->depth - 2 * b->depth + c->depth) > 0.02f + 0.3f * apart;
}

/* Whether all samples of the pixel show about the same: one colour is enough. */
static bool is_plain(const struct canvas *c, int x, int y)
{
	int s = c->samples, w = c->rays.view->width * s;
	const struct portrait_spot *first = &c->spots[(long)y * s * w + (long)x * s];
	for (int j = 0; j < s; j++)
		for (int i = 0; i < s; i++) {
			const struct portrait_spot *o = &first[(long)j * w + i];
			bool same = first->face < 0 ? o->face == first->face : o->face >= 0 && fabsf(o->depth - first->depth) < 0.8f;
			if (!same)
				return false;
		}
	if (first->face < 0)
		return true;
	float apart = first->depth / (float)(c->rays.view->focal_px * s);  // of samples on the skin, mm
	for (int k = 0; k < s; k++)
		for (int i = 0; i + 2 < s; i++) {
			const struct portrait_spot *row = &first[(long)k * w + i], *column = &first[(long)i * w + k];
			if (steps(row, row + 1, row + 2, apart) || steps(column, column + w, column + 2L * w, apart))
				return false;
		}
	return true;
}

/* Hairs before a sample of that colour. */
static void veil(float rgba[4], const struct canvas *c, const struct portrait_veil *v)
{
	float hair[3];
	if (v->face < 0)
		return;
	portrait_lash_colour(hair, c->p, v->face);
	for (int i = 0; i < 4; i++)
		rgba[i] = v->through * rgba[i] + (1 - v->through) * (i < 3 ? hair[i] : 1);
}

/* Colours of a pixel's samples, [samples][samples]. */
static void fine_pixel(float (*fine)[4], const struct canvas *c, int x, int y)
{
	int s = c->samples, w = c->rays.view->width * s;
	const struct portrait_spot *spots = &c->spots[(long)y * s * w + (long)x * s];
	bool plain = is_plain(c, x, y);
	if (plain)
		colour_at(fine[0], c, x + 0.5, y + 0.5, spots[(long)(s / 2) * w + s / 2]);
	for (int j = 0; j < s; j++)
		for (int i = 0; i < s; i++)
			if (!plain)
				colour_at(fine[j * s + i], c, x + (i + 0.5) / s, y + (j + 0.5) / s, spots[(long)j * w + i]);
			else if (i || j)
				memcpy(fine[j * s + i], fine[0], sizeof *fine);
	const long at = c->veils.at[(long)y * c->rays.view->width + x];
	for (int k = 0; k < s * s && at >= 0; k++)
		veil(fine[k], c, &c->veils.veil[at + k]);
}

/* Marks the pixels at hairs and shades their samples: the filter of neighbouring pixels reads them, too. */
static void find_hairs(struct canvas *c)
{
	int s = c->samples, width = c->rays.view->width, height = c->rays.view->height;
	long n = 0;
	c->hairy = mem_new((size_t)width * (size_t)height + 1, 1);
	c->fine_at = mem_array((size_t)width * (size_t)height + 1, sizeof *c->fine_at);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int k = 0; k < 25 && c->veils.at[(long)y * width + x] >= 0; k++) {
				int du = k % 5 - 2, dv = k / 5 - 2, a = x + du, b = y + dv, far = 1 + (abs(du) > 1 || abs(dv) > 1);
				if (a < 0 || b < 0 || a >= width || b >= height)
					continue;
				unsigned char *h = &c->hairy[(long)b * width + a];
				*h = (unsigned char)(*h && *h < far ? *h : far);
			}
	for (long i = 0; i < (long)width * height; i++)
		if (c->hairy[i]) {
			c->fine_at[i] = n;
			n += s * s;
		}
	c->fine = mem_array((size_t)n + 1, sizeof *c->fine);
#pragma omp parallel for schedule(dynamic, 4)
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			if (c->hairy[(long)y * width + x])
				fine_pixel(&c->fine[c->fine_at[(long)y * width + x]], c, x, y);
}

/* A pixel at hairs, which are finer than it: samples are weighted by a tent two pixels wide, so that hairs do not break into dots. */
static void draw_hairy(float rgba[4], const struct canvas *c, int x, int y)
{
	int s = c->samples, width = c->rays.view->width, height = c->rays.view->height;
	double sum[4] = { 0 }, all = 0;
	for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < height; v++)
		for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < width; u++) {
			const float (*fine)[4] = (const float(*)[4])&c->fine[c->fine_at[(long)v * width + u]];
			for (int k = 0; k < s * s; k++) {
				double w = fmax(1 - fabs(u - x + (k % s + 0.5) / s - 0.5), 0) * fmax(1 - fabs(v - y + (k / s + 0.5) / s - 0.5), 0);
				all += w;
				for (int i = 0; i < 4; i++)
					sum[i] += w * fminf(fine[k][i], 1.5f);
			}
		}
	for (int i = 0; i < 4; i++)
		rgba[i] = (float)(sum[i] / all);
}

static void draw_pixel(float rgba[4], const struct canvas *c, int x, int y)
{
	int s = c->samples, w = c->rays.view->width * s;
	const struct portrait_spot *spots = &c->spots[(long)y * s * w + (long)x * s];
	if (c->hairy[(long)y * c->rays.view->width + x] == 1) {
		draw_hairy(rgba, c, x, y);
		return;
	}
	if (is_plain(c, x, y)) {
		colour_at(rgba, c, x + 0.5, y + 0.5, spots[(long)(s / 2) * w + s / 2]);
		return;
	}
	float sum[4] = { 0 };
	for (int j = 0; j < s; j++)
		for (int i = 0; i < s; i++) {
			colour_at(rgba, c, x + (i + 0.5) / s, y + (j + 0.5) / s, spots[(long)j * w + i]);
			for (int k = 0; k < 4; k++)
				sum[k] += fminf(rgba[k], 1.5f) / (float)(s * s);
		}
	memcpy(rgba, sum, sizeof sum);
}

struct image portrait_draw(struct portrait *p, const struct portrait_view *view)
{
	struct image image = image_new(view->width, view->height, 4);
	portrait_lashes_move(p, view);
	struct portrait_spot *spots = portrait_raster(p, view, p->conf.samples);
	struct canvas c = { .p = p, .spots = spots, .rays = portrait_rays_of(view), .sky = portrait_sky_of(p, view), .samples = p->conf.samples };
	portrait_eyes(c.eye, c.eye_at, p, view, spots, p->conf.samples);
	c.glow = portrait_glow_of(p, view, spots, p->conf.samples);
	portrait_tears(c.eye, c.eye_at, p, view, spots, p->conf.samples);
	c.veils = portrait_veils_of(p, view, spots, p->conf.samples);
	find_hairs(&c);
#pragma omp parallel for schedule(dynamic, 4)
	for (int y = 0; y < view->height; y++)
		for (int x = 0; x < view->width; x++)
			draw_pixel(image_at(&image, x, y), &c, x, y);
	portrait_veils_free(&c.veils);
	portrait_glow_free(&c.glow);
	image_free(&c.eye[0]);
	image_free(&c.eye[1]);
	free(c.hairy);
	free(c.fine_at);
	free(c.fine);
	free(spots);
	return image;
}
