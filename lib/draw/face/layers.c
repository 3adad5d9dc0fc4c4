/* Depth, distance, normal and other layers of a picture, for compositors. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/distance/distance.h"
#include "math/vec.h"
#include "draw/face/impl.h"
#include "draw/face/skin_look.h"

static float lake_at(const struct portrait *p, const struct portrait_rays *rays, int side, double x, double y, float d)
{
	float dir[3], at[3];
	if (!(p->conf.tear_mm > 0) || !(d < (1 + (float)LAKE_RISE) * (float)p->conf.tear_mm))
		return 0;
	portrait_ray(dir, rays, x, y);
	float t = portrait_eye_hit(p, side, rays->origin, dir);
	for (int c = 0; c < 3; c++)
		at[c] = rays->origin[c] + t * dir[c];
	return isfinite(t) ? portrait_lake_depth(d, portrait_lake_height(p, side, at)) : 0;
}

/* The field of one eye into the picture. per_mm: the camera's unit in one of the rig's. */
static void eye_field(struct image *out, const struct portrait *p, const struct portrait_view *v, const struct portrait_spot *spots, int side,
                      double per_mm)
{
	int samples = p->conf.samples, w = v->width, h = v->height;
	size_t n = (size_t)w * (size_t)h;
	long row = (long)w * samples;
	uint8_t *material = mem_array(n, 1);
	float *cover = mem_array(n, sizeof *cover), *depth = mem_array(n, sizeof *depth), *distance = mem_array(n, sizeof *distance);
	double away = v->cam_from_target[2][3];
	for (int c = 0; c < 3; c++)
		away += v->cam_from_target[2][c] * p->rig->globe[side].center[c];
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			long i = (long)y * w + x;
			material[i] = portrait_material(&cover[i], spots + y * samples * row + (long)x * samples, row, samples, side);
		}
	struct portrait_rays rays = portrait_rays_of(v);
	// In view space, over the globe, as the tear line takes it.
	portrait_globe_depth(depth, p, &rays, side, (int[2]){ 0, 0 }, (int[2]){ w, h }, (float)away);
	const struct distance_scene scene = { w, h, material, cover, depth, v->focal_px, { v->center_px[0], v->center_px[1] } };
	if (away > 0)
		distance_band(distance, 0, &scene, PORTRAIT_REACH_MM * per_mm, 0);
	for (size_t i = 0; i < n && away > 0; i++) {
		float *px = out->px + PORTRAIT_LAYERS * i;
		if (material[i] != DISTANCE_GLOBE)
			continue;
		px[PORTRAIT_DISTANCE] = distance[i] / (float)per_mm;
		px[PORTRAIT_LAKE] = lake_at(p, &rays, side, (double)(i % (size_t)w) + 0.5, (double)(i / (size_t)w) + 0.5, px[PORTRAIT_DISTANCE]);
	}
	free(material);
	free(cover);
	free(depth);
	free(distance);
}

/* Of a globe: from where rays a little aside meet it. */
static void eye_normal(float n[3], const struct portrait *p, const struct portrait_rays *rays, int side, double x, double y)
{
	static const double aside[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
	double at[3][3], d[2][3], v[3] = { 0 };
	bool whole = true;
	for (int k = 0; k < 3; k++) {
		float dir[3];
		portrait_ray(dir, rays, x + aside[k][0], y + aside[k][1]);
		float t = portrait_eye_hit(p, side, rays->origin, dir);
		whole = whole && isfinite(t);
		for (int c = 0; c < 3; c++)
			at[k][c] = (double)t * (double)dir[c];
	}
	if (whole) {
		vec_add(d[0], at[1], -1, at[0]);
		vec_add(d[1], at[2], -1, at[0]);
		vec_cross(v, d[1], d[0]);  // rows run down: towards the camera
		vec_unit(v, v);
	}
	for (int c = 0; c < 3; c++)
		n[c] = (float)v[c];
}

static void normal_of(float out[3], const struct portrait *p, const struct portrait_rays *rays, const struct portrait_spot *spot, double x, double y)
{
	float n[3], dir[3];
	portrait_ray(dir, rays, x, y);
	if (spot->face < -1)
		eye_normal(n, p, rays, -2 - spot->face, x, y);
	else
		portrait_normal(n, p, spot->face, rays->origin, dir);
	for (int k = 0; k < 3; k++)
		out[k] = (float)(rays->rig_from_cam[0][k] * (double)n[0] + rays->rig_from_cam[1][k] * (double)n[1] + rays->rig_from_cam[2][k] * (double)n[2]);
}

static void pixel(float *px, const struct portrait *p, const struct portrait_rays *rays, const struct portrait_spot *spot, double per_mm, const float *full,
                  const float *matte, double x, double y)
{
	px[PORTRAIT_Z] = isfinite(spot->depth) ? spot->depth / (float)per_mm : 0;
	px[PORTRAIT_DISTANCE] = INFINITY;
	if (spot->face != -1)
		normal_of(px + PORTRAIT_NORMAL, p, rays, spot, x, y);
	for (int c = 0; c < 3; c++) {
		px[PORTRAIT_DIFFUSE + c] = matte[c];
		px[PORTRAIT_SPECULAR + c] = full[c] - matte[c];
	}
}

struct image portrait_layers(struct portrait *p, const struct portrait_view *v, const struct image *picture)
{
	struct image out = image_new(v->width, v->height, PORTRAIT_LAYERS);
	int samples = p->conf.samples;
	double per_mm = vec_norm(v->cam_from_target[0]);
	p->matte = true;
	struct image matte = portrait_draw(p, v);
	p->matte = false;
	struct portrait_spot *spots = portrait_raster(p, v, samples);
	struct portrait_rays rays = portrait_rays_of(v);
	struct portrait_veils veils = portrait_veils_of(p, v, spots, samples);
	for (int y = 0; y < v->height; y++)
		for (int x = 0; x < v->width; x++) {
			struct portrait_spot spot = spots[((long)y * samples + samples / 2) * v->width * samples + (long)x * samples + samples / 2];
			const long at = veils.at[(long)y * v->width + x];
			const struct portrait_veil *hair = at < 0 ? 0 : &veils.veil[at + samples / 2 * samples + samples / 2];
			if (hair && hair->through < 0.5f)  // a depth has no shares: what hides more
				spot = (struct portrait_spot){ hair->face, hair->depth };
			pixel(image_at(&out, x, y), p, &rays, &spot, per_mm, image_at(picture, x, y), image_at(&matte, x, y), x + 0.5, y + 0.5);
		}
	for (int side = 0; side < 2; side++)
		eye_field(&out, p, v, spots, side, per_mm);
	image_free(&matte);
	portrait_veils_free(&veils);
	free(spots);
	return out;
}
