/* Subsurface scattering: the irradiance of the skin in the picture, blurred on the screen by the skin's profile. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/subsurface/subsurface.h"
#include "math/vec.h"
#include "draw/face/impl.h"

/* The irradiance at a pixel's middle; 0 and no depth where it shows no skin, but a lash or an eye. */
static void pixel(struct portrait_glow *g, const struct portrait *p, const struct portrait_rays *rays, const struct portrait_spot *spot,
                  int x, int y)
{
	float dir[3], rgb[3] = { 0 };
	long at = (long)y * g->width + x;
	bool skin = spot->face >= 0;
	if (skin) {
		portrait_ray(dir, rays, x + 0.5, y + 0.5);
		portrait_bare_light(rgb, p, spot->face, rays->origin, dir);
	}
	g->depth[at] = skin ? spot->depth / g->scale : 0;
	for (int c = 0; c < 3; c++)
		g->rgb[c][at] = rgb[c];
}

/* Mean depth of the skin in the picture: one scale does for all of it. 0: there is none. */
static double mean_depth(const struct portrait_glow *g)
{
	double sum = 0;
	long n = 0;
	for (long i = 0; i < (long)g->width * g->height; i++)
		if (g->depth[i] > 0) {
			sum += (double)g->depth[i];
			n++;
		}
	return n ? sum / (double)n : 0;
}

struct portrait_glow portrait_glow_of(const struct portrait *p, const struct portrait_view *v, const struct portrait_spot *spots, int samples)
{
	struct portrait_glow g = { .width = v->width, .height = v->height, .scale = (float)vec_norm(v->cam_from_target[0]) };
	struct portrait_rays rays = portrait_rays_of(v);
	size_t n = (size_t)v->width * (size_t)v->height;
	for (int c = 0; c < 3; c++)
		g.rgb[c] = mem_array(n, sizeof *g.rgb[c]);
	g.depth = mem_array(n, sizeof *g.depth);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < v->height; y++)
		for (int x = 0; x < v->width; x++)
			pixel(&g, p, &rays, &spots[((long)y * samples + samples / 2) * v->width * samples + (long)x * samples + samples / 2], x, y);
	double depth = mean_depth(&g);
	if (depth > 0 && p->conf.scatter_mm > 0) {
		struct subsurface_profile skin = subsurface_skin(p->conf.scatter_mm / 1.5);
		struct subsurface_room room = { 0 };
		subsurface_spread(&(struct subsurface_picture){ g.width, g.height, { g.rgb[0], g.rgb[1], g.rgb[2] }, g.depth, v->focal_px / depth }, &skin, &room);
		subsurface_room_free(&room);
	}
	return g;
}

bool portrait_glow_at(float rgb[3], const struct portrait_glow *g, double x, double y, float depth)
{
	static const float apart = 0.3f;  // mm: further behind each other are two surfaces
	int u = (int)x, v = (int)y;
	float sum = 0;
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int k = 0; k < 9; k++) {
		int a = u + k % 3 - 1, b = v + k / 3 - 1;
		if (a < 0 || b < 0 || a >= g->width || b >= g->height || !(g->depth[(long)b * g->width + a] > 0))
			continue;
		long at = (long)b * g->width + a;
		float dx = (float)(a + 0.5 - x), dy = (float)(b + 0.5 - y), dz = (g->depth[at] - depth / g->scale) / apart;
		float w = fmaxf(1.0f - fabsf(dx), 0.01f) * fmaxf(1.0f - fabsf(dy), 0.01f) / ((1 + dz * dz) * (1 + dz * dz));
		sum += w;
		for (int c = 0; c < 3; c++)
			rgb[c] += w * g->rgb[c][at];
	}
	if (!(sum > 1e-4f))
		return false;
	for (int c = 0; c < 3; c++)
		rgb[c] /= sum;
	return true;
}

void portrait_glow_free(struct portrait_glow *g)
{
	for (int c = 0; c < 3; c++)
		free(g->rgb[c]);
	free(g->depth);
	*g = (struct portrait_glow){ 0 };
}
