/* The eyes of a portrait: pictures of draw/eye, where samples show an eye. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/look.h"
#include "draw/eye/render.h"
#include "draw/face/impl.h"
#include "draw/face/sky.h"
#include "math/vec.h"

/* rig_from_eye: columns x, y, z of the eye's frame (lib/README.md: z into the eye, x and y as a camera before it has them), for a
 * globe turned so. */
static void eye_axes(double axes[3][3], const double target_from_globe[3][3])
{
	for (int i = 0; i < 3; i++) {
		axes[i][0] = target_from_globe[i][0];
		axes[i][1] = -target_from_globe[i][1];
		axes[i][2] = -target_from_globe[i][2];
	}
}

/* mm of the rig in one of the eye's. */
static double eye_scale(const struct portrait *p, int side)
{
	return p->rig->globe[side].radius / p->eye[side]->conf.sclera_radius;
}

/* Nearest root of |o + t d - c| = r that lies on the cap beyond depth `from` along the axis. */
static double ball_hit(const double o[3], const double d[3], double cz, double r, double above)
{
	double q[3] = { o[0], o[1], o[2] - cz }, b = vec_dot(q, d), disc = b * b - vec_dot(q, q) + r * r;
	if (disc < 0)
		return INFINITY;
	double t = -b - sqrt(disc);
	return t > 0 && o[2] + t * d[2] <= above ? t : INFINITY;
}

float portrait_eye_hit(const struct portrait *p, int side, const float origin[3], const float dir[3])
{
	const struct scene *s = p->eye[side];
	double axes[3][3], o[3], d[3], scale = eye_scale(p, side), from[3], along[3] = { dir[0], dir[1], dir[2] };
	eye_axes(axes, p->target_from_globe[side]);
	for (int c = 0; c < 3; c++)
		from[c] = (origin[c] - p->rig->globe[side].center[c]) / scale;
	mat_tvec(o, axes, from);
	mat_tvec(d, axes, along);
	o[2] += s->sclera_z;  // the eye's frame begins at the corneal apex
	// The cornea's conic as the sphere through its apex and the limbus: what decides which of eye and lid is nearer.
	double r = s->limbus[0], z = s->limbus_depth, R = (r * r + z * z) / (2 * z);
	double t = fmin(ball_hit(o, d, s->sclera_z, s->conf.sclera_radius, INFINITY), ball_hit(o, d, R, R, z));
	return (float)(t * scale);
}

static struct scene_view eye_view(const struct portrait *p, const struct portrait_view *v, int side)
{
	const struct scene *s = p->eye[side];
	const struct rig_globe *g = &p->rig->globe[side];
	struct scene_view view = { .scale = 1, .samples = p->conf.eye_samples };
	double axes[3][3], scale = eye_scale(p, side), cam_scale = 0;
	view.camera = (struct camera){ .focal_px = v->focal_px, .center_px = { v->center_px[0], v->center_px[1] }, .source = CAMERA_CONF };
	eye_axes(axes, p->target_from_globe[side]);
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

/* Lids darken the eye below them: they leave it some of its sky, of which the light is that about its middle. */
static void shade_eye(struct image *image, const int corner[2], const struct portrait *p, const struct portrait_rays *rays, int side)
{
	const double *center = p->rig->globe[side].center;
#pragma omp parallel for schedule(dynamic, 4)
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++) {
			float dir[3], at[3], normal[3], len = 0, *px = image_at(image, x, y);
			portrait_ray(dir, rays, corner[0] + x + 0.5, corner[1] + y + 0.5);
			float t = portrait_eye_hit(p, side, rays->origin, dir);
			if (!isfinite(t) || px[3] == 0)
				continue;
			for (int c = 0; c < 3; c++) {
				at[c] = rays->origin[c] + t * dir[c];
				normal[c] = at[c] - (float)center[c];
				len += normal[c] * normal[c];
			}
			for (int c = 0; c < 3; c++)
				normal[c] /= sqrtf(len);
			static const float bounce[3] = { LOOK_BOUNCE };  // light off the lids
			float middle[3], to[2][3], light[2][3];
			const float open = portrait_sky_over(middle, p, at, normal);
			for (int c = 0; c < 3; c++) {
				to[0][c] = to[1][c] = 0;
				for (int k = 0; k < 3; k++) {
					to[0][c] += (float)rays->rig_from_cam[k][c] * normal[k];
					to[1][c] += (float)rays->rig_from_cam[k][c] * middle[k];
				}
			}
			for (int k = 0; k < 2; k++)
				envmap_wet(light[k], p->env, to[k]);
			for (int c = 0; c < 3; c++)
				px[c] *= open * fminf(fmaxf(light[1][c], 0.02f) / fmaxf(light[0][c], 0.02f), 2) + bounce[c] * (1 - open);
		}
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
		free(visible);
		shade_eye(&out[side], at[side], p, &rays, side);
	}
}
