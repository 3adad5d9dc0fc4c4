/* Rays of sight through a pinhole. */
#include "draw/eye/exact/sight.h"

#include <math.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see draw/eye/march/meet.c
#endif

struct sight_plane sight_plane(const struct scene_look *look, const struct scene_view *v, double sphere_z)
{
	struct sight_plane p;
	double per = v->scale / v->camera.focal_px, center = v->cam_from_eye[2][2] * sphere_z + v->cam_from_eye[2][3];
	double depth = fmax(center - 16, 0);  // mm: the eye reaches 14 before its centre at most
	for (int j = 0; j < 3; j++) {
		double step[3] = { (v->x0 - v->camera.center_px[0]) / v->camera.focal_px, (v->y0 - v->camera.center_px[1]) / v->camera.focal_px, 1 };
		double d[3] = { 0, per * v->cam_from_eye[0][j], per * v->cam_from_eye[1][j] };
		for (int i = 0; i < 3; i++)
			d[0] += v->cam_from_eye[i][j] * step[i];
		for (int k = 0; k < 3; k++) {
			p.dir[k][j] = (float)d[k];
			p.from[k][j] = (float)(depth * d[k] + (k == 0 ? look->origin[j] : 0));
		}
	}
	return p;
}

SIMD_CLONES void sight_rays_make(struct quick_rays *r, const float *restrict x, const float *restrict y, const void *plane)
{
	const struct sight_plane *p = plane;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float dx = p->dir[0][0] + x[i] * p->dir[1][0] + y[i] * p->dir[2][0], dy = p->dir[0][1] + x[i] * p->dir[1][1] + y[i] * p->dir[2][1];
		float dz = p->dir[0][2] + x[i] * p->dir[1][2] + y[i] * p->dir[2][2], inv = 1 / sqrtf(dx * dx + dy * dy + dz * dz);
		r->dx[i] = dx * inv;
		r->dy[i] = dy * inv;
		r->dz[i] = dz * inv;
		r->ox[i] = p->from[0][0] + x[i] * p->from[1][0] + y[i] * p->from[2][0];
		r->oy[i] = p->from[0][1] + x[i] * p->from[1][1] + y[i] * p->from[2][1];
		r->oz[i] = p->from[0][2] + x[i] * p->from[1][2] + y[i] * p->from[2][2];
	}
}
