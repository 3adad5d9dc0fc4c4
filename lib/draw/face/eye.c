/* The eyes of a portrait: pictures of draw/eye, where samples show an eye. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/render.h"
#include "draw/face/impl.h"
#include "math/vec.h"

static struct scene_view eye_view(const struct portrait *p, const struct portrait_view *v, int side)
{
	const struct scene *s = p->eye[side];
	const struct rig_globe *g = &p->rig->globe[side];
	struct scene_view view = { .scale = 1, .samples = p->conf.eye_samples };
	double axes[3][3], scale = portrait_eye_scale(p, side), cam_scale = 0;
	view.camera = (struct camera){ .focal_px = v->focal_px, .center_px = { v->center_px[0], v->center_px[1] }, .source = CAMERA_CONF };
	portrait_eye_axes(axes, p, side);
	for (int k = 0; k < 3; k++)
		cam_scale += v->cam_from_target[0][k] * v->cam_from_target[0][k];
	cam_scale = sqrt(cam_scale);
	for (int i = 0; i < 3; i++) {
		double center = v->cam_from_target[i][3];
		for (int k = 0; k < 3; k++) {
			center += v->cam_from_target[i][k] * g->center[k];
			for (int j = 0; j < 3; j++)
				view.cam_from_eye[i][j] += v->cam_from_target[i][k] * axes[k][j] / cam_scale;
		}
		// Everything in the eye's own mm: a larger eye further away by as much looks the same.
		view.cam_from_eye[i][3] = center / (cam_scale * scale) - view.cam_from_eye[i][2] * s->sclera_z;
	}
	view.cam_from_eye[3][3] = 1;
	return view;
}

/* The bounding box of pixels of which a sample shows that eye: x0, y0, x1, y1, exclusive; false: none. */
static bool window_of(int window[4], const struct portrait_view *v, const struct portrait_spot *spots, int samples, int side)
{
	window[0] = v->width;
	window[1] = v->height;
	window[2] = window[3] = 0;
	for (int y = 0; y < v->height * samples; y++)
		for (int x = 0; x < v->width * samples; x++)
			if (spots[(long)y * v->width * samples + x].face == -2 - side) {
				window[0] = window[0] < x / samples ? window[0] : x / samples;
				window[1] = window[1] < y / samples ? window[1] : y / samples;
				window[2] = window[2] > x / samples ? window[2] : x / samples + 1;
				window[3] = window[3] > y / samples ? window[3] : y / samples + 1;
			}
	return window[2] > window[0];
}

/* Marks the pixels of the window of which a sample shows the eye, and their neighbours, whose colours are read, too. free(). */
static unsigned char *visible_of(const int window[4], const struct portrait_view *v, const struct portrait_spot *spots, int samples, int side)
{
	int w = window[2] - window[0], h = window[3] - window[1];
	unsigned char *out = mem_new((size_t)w * (size_t)h, 1);
	for (int y = window[1] * samples; y < window[3] * samples; y++)
		for (int x = window[0] * samples; x < window[2] * samples; x++) {
			if (spots[(long)y * v->width * samples + x].face != -2 - side)
				continue;
			int cx = x / samples - window[0], cy = y / samples - window[1];
			for (int k = 0; k < 9; k++) {
				int a = cx + k % 3 - 1, b = cy + k / 3 - 1;
				if (a >= 0 && b >= 0 && a < w && b < h)
					out[(long)b * w + a] = 1;
			}
		}
	return out;
}

static bool behind_lid(const struct portrait *p, const float origin[3], const float dir[3], const float at[3])
{
	float t = 0;
	for (int c = 0; c < 3; c++)
		t += (at[c] - origin[c]) * dir[c];
	return ray_blocked(p->shadow, origin, dir, 0, t - 0.02f);
}

/* Pixels that show the eye become, where they are not seen, the mean of those beside them that are; further in they stay. */
static void take_beside(struct image *image, const unsigned char *seen)
{
	const int w = image->width, h = image->height;
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			float sum[4] = { 0 };
			int n = 0;
			for (int k = 0; k < 9 && !seen[(long)y * w + x]; k++) {
				const int u = x + k % 3 - 1, v = y + k / 3 - 1;
				if (u < 0 || v < 0 || u >= w || v >= h || !seen[(long)v * w + u])
					continue;
				for (int c = 0; c < 4; c++)
					sum[c] += image_at(image, u, v)[c];
				n++;
			}
			for (int c = 0; c < 4 && n; c++)
				image_at(image, x, y)[c] = sum[c] / (float)n;
		}
}

/* Lids and lashes before the light: of a picture of the eye alone, and the same without what its outside mirrors. Pixels whose middle lies behind a lid are
 * as their neighbours that show the eye. */
static void shade_eye(struct image *image, const struct image *matte, const int corner[2], const struct portrait *p, const struct portrait_rays *rays, int side)
{
	struct portrait_beneath *beneath = portrait_beneath_new(p, rays, side);
	const int w = image->width, h = image->height;
	unsigned char *seen = mem_new((size_t)w * (size_t)h + 1, 1);
#pragma omp parallel for schedule(dynamic, 4)
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			float dir[3], share[3], skin[3], *px = image_at(image, x, y);
			const float *own = image_at(matte, x, y);
			struct portrait_eye_spot spot;
			portrait_ray(dir, rays, corner[0] + x + 0.5, corner[1] + y + 0.5);
			if (px[3] == 0 || !portrait_eye_meet(&spot, p, side, rays->origin, dir) || behind_lid(p, rays->origin, dir, spot.at))
				continue;
			portrait_beneath_light(share, beneath, &spot);
			const float room = p->matte ? 0 : portrait_beneath_mirrored(skin, beneath, &spot, dir);
			for (int c = 0; c < 3; c++)
				px[c] = own[c] * share[c] + (p->matte ? 0 : px[3] * skin[c] + room * (px[c] - own[c]));
			seen[(long)y * w + x] = 1;
		}
	take_beside(image, seen);
	free(seen);
	portrait_beneath_free(beneath);
}

void portrait_eyes(struct image out[2], int at[2][2], const struct portrait *p, const struct portrait_view *v,
                   const struct portrait_spot *spots, int samples)
{
	struct portrait_rays rays = portrait_rays_of(v);
	struct scene_lighting light = { 0 };  // a closed eye needs none
	for (int side = 0; side < 2; side++) {
		int window[4];
		out[side] = (struct image){ 0 };
		if (!window_of(window, v, spots, samples, side))
			continue;
		struct scene_view view = eye_view(p, v, side);
		struct scene_count count = { 0 };
		view.x0 = at[side][0] = window[0];
		view.y0 = at[side][1] = window[1];
		view.width = window[2] - window[0];
		view.height = window[3] - window[1];
		unsigned char *visible = visible_of(window, v, spots, samples, side);
		view.visible = visible;
		if (!light.n)
			light = scene_lighting(p->env, p->matte ? 0 : p->env, 8);
		out[side] = scene_render(p->eye[side], &view, &light, &count);
		struct image matte = { 0 };
		if (!p->matte) {
			struct scene_lighting dull = light;
			dull.mirror = 0;
			matte = scene_render(p->eye[side], &view, &dull, &count);
		}
		shade_eye(&out[side], p->matte ? &out[side] : &matte, at[side], p, &rays, side);
		image_free(&matte);
		free(visible);
	}
}
