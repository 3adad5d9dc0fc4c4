/* Light on the skin: irradiance with shadows at the rig's vertices, then spread along the surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "draw/face/impl.h"
#include "draw/face/sky.h"

int portrait_lights(struct envmap_light light[], int n, const struct portrait *p, const struct portrait_rays *rays)
{
	n = envmap_lights(light, n, p->env);
	for (int i = 0; i < n; i++) {
		float cam[3];
		memcpy(cam, light[i].dir, sizeof cam);
		for (int k = 0; k < 3; k++)
			light[i].dir[k] = (float)(rays->rig_from_cam[k][0] * (double)cam[0] + rays->rig_from_cam[k][1] * (double)cam[1] + rays->rig_from_cam[k][2] * (double)cam[2]);
	}
	return n;
}

struct portrait_sky portrait_sky_of(const struct portrait *p, const struct portrait_view *view)
{
	struct portrait_sky sky;
	struct portrait_rays rays = portrait_rays_of(view);
	// Pores are half a millimetre apart.
	double mm = vec_norm((double[]){ view->cam_from_target[0][3], view->cam_from_target[1][3], view->cam_from_target[2][3] }) / view->focal_px;
	sky.pixel_mm = (float)mm;
	sky.detail = (float)fmin(fmax((0.22 - mm) / 0.1, 0), 1);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			sky.rig_from_cam[i][k] = (float)rays.rig_from_cam[i][k];
	sky.n = portrait_lights(sky.light, p->conf.lights, p, &rays);
	return sky;
}

enum { RAYS = 24 };
static const float lift_mm = 0.15f, from_mm = 0.25f, far_mm = 120;

/* Light that comes from the environment alone. Returns whether skin stands before some of it. */
static bool light_vertex(struct portrait *p, const struct portrait_sky *sky, int i)
{
	const float *x = p->mesh.x[i], *n = p->mesh.normal[i];
	float sum[3] = { 0 }, open = 0, all = 1e-9f, from[3];
	bool beside = false;
	for (int c = 0; c < 3; c++)
		from[c] = x[c] + lift_mm * n[c];
	for (int k = 0; k < sky->n; k++) {
		const float *d = sky->light[k].dir, *rgb = sky->light[k].rgb;
		float facing = d[0] * n[0] + d[1] * n[1] + d[2] * n[2], weight = rgb[1] * fmaxf(facing, 0);
		if (!(facing > 0))
			continue;
		all += weight;
		if (ray_blocked(p->shadow, from, d, from_mm, far_mm)) {
			beside = true;
			continue;
		}
		open += weight;
		for (int c = 0; c < 3; c++)
			sum[c] += facing * rgb[c];
	}
	memcpy(p->direct[i], sum, sizeof sum);
	memcpy(p->lit_at[i], x, 3 * sizeof *x);
	p->mesh.open[i] = open / all;
	return beside;
}

bool portrait_skin_light(float rgb[3], const struct portrait *p, const float (*light)[3], const float at[3], const float dir[3], float from, float to)
{
	const struct ray_hit hit = ray_first(p->shadow, at, dir, from, to);
	if (hit.face < 0)
		return false;
	const int32_t *v = p->solid[hit.face];
	const float w[3] = { 1 - hit.u - hit.v, hit.u, hit.v };
	float x[3];
	for (int c = 0; c < 3; c++)
		x[c] = at[c] + hit.t * dir[c];
	const float under = portrait_under_hair(p, x, p->mesh.normal[v[0]]);
	for (int c = 0; c < 3; c++) {
		rgb[c] = 0;
		for (int k = 0; k < 3; k++)
			rgb[c] += under * w[k] * light[v[k]][c] * p->mesh.albedo[v[k]][c];
	}
	return true;
}

/* Light that skin sends to other skin, in creases and sockets: once from each direction in which there is some, and from there on as in a hollow that is as
 * closed and as bright everywhere. */
static void light_between(struct portrait *p, int i)
{
	const float *x = p->mesh.x[i], *n = p->mesh.normal[i];
	float sum[3] = { 0 }, from[3], hidden = 0;
	const struct portrait_fan fan = portrait_fan_of(n);
	for (int c = 0; c < 3; c++)
		from[c] = x[c] + lift_mm * n[c];
	for (int k = 0; k < RAYS; k++) {
		float dir[3], rgb[3];
		portrait_fan_ray(dir, &fan, k, RAYS);
		if (!portrait_skin_light(rgb, p, (const float(*)[3])p->direct, from, dir, from_mm, far_mm))
			continue;
		hidden += 1.0f / RAYS;
		for (int c = 0; c < 3; c++)
			sum[c] += rgb[c] / RAYS;
	}
	for (int c = 0; c < 3; c++)
		p->lit[i][c] += sum[c] / (1 - fminf(hidden * p->mesh.albedo[i][c], 0.8f));
}

/* One round of diffusion over the mesh; rate: of each colour. */
static void spread(struct portrait *p, float (*light)[3], const float rate[3])
{
	int n = p->rig->n;
	float (*next)[3] = mem_array((size_t)n + 1, sizeof *next);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < n; i++) {
		float sum[3] = { 0 }, total[3] = { 1, 1, 1 };
		for (int k = p->near_start[i]; k < p->near_start[i + 1]; k++)
			for (int c = 0; c < 3; c++) {
				float w = rate[c] * p->spread[k];
				sum[c] += w * light[p->near[k]][c];
				total[c] += w;
			}
		for (int c = 0; c < 3; c++)
			next[i][c] = (light[i][c] + sum[c]) / total[c];
	}
	memcpy(light, next, (size_t)n * sizeof *next);
	free(next);
}

void portrait_light(struct portrait *p, const struct portrait_view *view, bool all)
{
	static const float rate[3] = { 1, 0.35f, 0.18f };  // green and blue travel less far
	struct portrait_mesh *m = &p->mesh;
	struct portrait_sky sky = portrait_sky_of(p, view);
	for (int side = 0; side < 2; side++) {
		portrait_fringe_free(p->fringe[side]);
		p->fringe[side] = portrait_fringe_new(p, side, true, sky.n, sky.light);
	}
	enum { KEPT, OPEN, BESIDE };
	uint8_t *fresh = mem_new((size_t)p->rig->n + 1, sizeof *fresh);
#pragma omp parallel for schedule(dynamic, 64)
	for (int i = 0; i < p->rig->n; i++) {
		float moved = 0;
		for (int c = 0; c < 3; c++)
			moved += fabsf(p->lit_at[i][c] - m->x[i][c]);
		// A quarter of a millimetre changes no shadow that is seen; whole faces of vertices stand still.
		if (p->near_start[i + 1] > p->near_start[i] && (all || moved > 0.25f))
			fresh[i] = light_vertex(p, &sky, i) ? BESIDE : OPEN;
	}
#pragma omp parallel for schedule(dynamic, 64)
	for (int i = 0; i < p->rig->n; i++) {
		if (fresh[i] != KEPT)
			memcpy(p->lit[i], p->direct[i], sizeof *p->lit);
		if (fresh[i] == BESIDE)
			light_between(p, i);
	}
	free(fresh);
	memcpy(m->bare, p->lit, (size_t)p->rig->n * sizeof *m->bare);
	memcpy(m->light, p->lit, (size_t)p->rig->n * sizeof *m->light);
	for (int round = 0; round < 2; round++)
		spread(p, m->light, rate);
	for (int i = m->n_base; i < m->n; i++) {
		const int *e = m->between[i - m->n_base];
		for (int c = 0; c < 3; c++) {
			m->light[i][c] = 0.5f * (m->light[e[0]][c] + m->light[e[1]][c]);
			m->bare[i][c] = 0.5f * (m->bare[e[0]][c] + m->bare[e[1]][c]);
		}
		m->open[i] = 0.5f * (m->open[e[0]] + m->open[e[1]]);
	}
}
