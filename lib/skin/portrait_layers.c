/* What a picture is of, beside its colours. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/distance.h"
#include "math/vec.h"
#include "skin/portrait_impl.h"
#include "skin/skin_look.h"

enum { Z, DISTANCE, LAKE, CHANNELS };

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
	float *cover = mem_array(n, sizeof *cover), *distance = mem_array(n, sizeof *distance);
	double away = v->cam_from_target[2][3];
	for (int c = 0; c < 3; c++)
		away += v->cam_from_target[2][c] * p->rig->globe[side].center[c];
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			long i = (long)y * w + x;
			material[i] = portrait_material(&cover[i], p, spots + y * samples * row + (long)x * samples, row, samples, side);
		}
	struct portrait_rays rays = portrait_rays_of(v);
	// Across the screen, as the tear line takes it.
	double mm = away / (v->focal_px * per_mm);
	struct distance_scene scene = { w, h, material, cover, 0, 0, { 0, 0 } };
	if (away > 0)
		distance_band(distance, 0, &scene, PORTRAIT_REACH_MM / mm, 0);
	for (size_t i = 0; i < n && away > 0; i++) {
		float *px = out->px + CHANNELS * i;
		if (material[i] != DISTANCE_GLOBE)
			continue;
		px[DISTANCE] = distance[i] * (float)mm;
		px[LAKE] = lake_at(p, &rays, side, (double)(i % (size_t)w) + 0.5, (double)(i / (size_t)w) + 0.5, px[DISTANCE]);
	}
	free(material);
	free(cover);
	free(distance);
}

struct image portrait_layers(struct portrait *p, const struct portrait_view *v)
{
	struct image out = image_new(v->width, v->height, CHANNELS);
	int samples = p->conf.samples;
	double per_mm = vec_norm(v->cam_from_target[0]);
	portrait_lashes_move(p, v);
	struct portrait_spot *spots = portrait_raster(p, v, samples);
	for (int y = 0; y < v->height; y++)
		for (int x = 0; x < v->width; x++) {
			float *px = image_at(&out, x, y);
			float depth = spots[((long)y * samples + samples / 2) * v->width * samples + (long)x * samples + samples / 2].depth;
			px[Z] = isfinite(depth) ? depth / (float)per_mm : 0;
			px[DISTANCE] = INFINITY;
		}
	for (int side = 0; side < 2; side++)
		eye_field(&out, p, v, spots, side, per_mm);
	free(spots);
	return out;
}
