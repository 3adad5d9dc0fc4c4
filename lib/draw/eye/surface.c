#include "draw/eye/surface.h"

#include <math.h>

#include "draw/eye/batch_impl.h"
#include "math/vec.h"

struct sight {
	double origin[3], sphere_z, sphere_r;
	const struct scene *scene;
	const struct scene_view *view;
};

/* Nearest of cornea and sclera along d (unit, eye's frame): the point and its normal. */
static bool meet(double at[3], double normal[3], const struct sight *s, const double d[3])
{
	double K[3], tk = INFINITY, ts = INFINITY, q[3] = { s->origin[0], s->origin[1], s->origin[2] - s->sphere_z };
	double b = vec_dot(q, d), disc = b * b - vec_dot(q, q) + s->sphere_r * s->sphere_r;
	if (cornea_hit(K, &s->scene->cornea, s->origin, d))
		tk = (K[0] - s->origin[0]) * d[0] + (K[1] - s->origin[1]) * d[1] + (K[2] - s->origin[2]) * d[2];
	if (disc >= 0 && -b - sqrt(disc) > 0)
		ts = -b - sqrt(disc);
	if (isinf(tk) && isinf(ts))
		return false;
	for (int i = 0; i < 3; i++) {
		at[i] = s->origin[i] + fmin(tk, ts) * d[i];
		normal[i] = (at[i] - (i == 2 ? s->sphere_z : 0)) / s->sphere_r;
	}
	if (tk <= ts)
		cornea_normal(normal, &s->scene->cornea, at);
	return true;
}

static void pixel(float out[4], const struct sight *s, int x, int y)
{
	const struct scene_view *v = s->view;
	double px[2] = { v->x0 + v->scale * (x + 0.5), v->y0 + v->scale * (y + 0.5) }, cam[3], d[3], at[3], n[3];
	camera_ray(cam, &v->camera, px);
	for (int j = 0; j < 3; j++)
		d[j] = v->cam_from_eye[0][j] * cam[0] + v->cam_from_eye[1][j] * cam[1] + v->cam_from_eye[2][j] * cam[2];
	vec_unit(d, d);
	if (!meet(at, n, s, d)) {
		out[0] = INFINITY;
		return;
	}
	out[0] = (float)(v->cam_from_eye[2][0] * at[0] + v->cam_from_eye[2][1] * at[1] + v->cam_from_eye[2][2] * at[2] + v->cam_from_eye[2][3]);
	for (int i = 0; i < 3; i++)
		out[1 + i] = (float)(v->cam_from_eye[i][0] * n[0] + v->cam_from_eye[i][1] * n[1] + v->cam_from_eye[i][2] * n[2]);
}

struct image scene_surface(const struct scene *s, const struct scene_view *view)
{
	struct image out = image_new(view->width, view->height, 4);
	struct sight sight = { .scene = s, .view = view, .sphere_z = s->sclera_z, .sphere_r = s->conf.sclera_radius };
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++)
			sight.origin[j] -= view->cam_from_eye[i][j] * view->cam_from_eye[i][3];
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < view->height; y++)
		for (int x = 0; x < view->width; x++)
			pixel(image_at(&out, x, y), &sight, x, y);
	return out;
}

double scene_relief_height(const struct scene *s, double x, double y)
{
	float gx, gy;
	return relief_at(s->level[0].relief, s->level[0].n, s->level[0].per_mm, (float)x, (float)y, &gx, &gy);
}
