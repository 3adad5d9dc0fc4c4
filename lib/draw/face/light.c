/* Light on the skin: irradiance with shadows at the rig's vertices, then spread along the surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "draw/eye/look.h"
#include "draw/face/impl.h"

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
	sky.n = envmap_lights(sky.light, p->conf.lights, p->env);
	for (int i = 0; i < sky.n; i++) {
		float cam[3];
		memcpy(cam, sky.light[i].dir, sizeof cam);
		for (int k = 0; k < 3; k++)
			sky.light[i].dir[k] = (float)(rays.rig_from_cam[k][0] * cam[0] + rays.rig_from_cam[k][1] * cam[1] + rays.rig_from_cam[k][2] * cam[2]);
	}
	return sky;
}

static const float crease_mm = 8, bounce[3] = { LOOK_BOUNCE };

static void light_vertex(struct portrait *p, const struct portrait_sky *sky, int i)
{
	const float *x = p->mesh.x[i], *n = p->mesh.normal[i];
	float sum[3] = { 0 }, open = 0, all = 1e-9f, from[3];
	for (int c = 0; c < 3; c++)
		from[c] = x[c] + 0.15f * n[c];
	for (int k = 0; k < sky->n; k++) {
		const float *d = sky->light[k].dir, *rgb = sky->light[k].rgb;
		float facing = d[0] * n[0] + d[1] * n[1] + d[2] * n[2], weight = rgb[1] * fmaxf(facing, 0);
		if (!(facing > 0))
			continue;
		all += weight;
		if (ray_blocked(p->shadow, from, d, 0.25f, 120)) {
			// Skin close by is lit by much the same light and reflects some of it: without that, what lies in the crease between two lids has
			// nothing but the red that spreads through them.
			for (int c = 0; c < 3 && ray_blocked(p->shadow, from, d, 0.25f, crease_mm); c++)
				sum[c] += bounce[c] * facing * rgb[c];
			continue;
		}
		open += weight;
		for (int c = 0; c < 3; c++)
			sum[c] += facing * rgb[c];
	}
	memcpy(p->lit[i], sum, sizeof sum);
	memcpy(p->lit_at[i], x, 3 * sizeof *x);
	p->mesh.open[i] = open / all;
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
#pragma omp parallel for schedule(dynamic, 64)
	for (int i = 0; i < p->rig->n; i++) {
		float moved = 0;
		for (int c = 0; c < 3; c++)
			moved += fabsf(p->lit_at[i][c] - m->x[i][c]);
		// A quarter of a millimetre changes no shadow that is seen; whole faces of vertices stand still.
		if (p->near_start[i + 1] > p->near_start[i] && (all || moved > 0.25f))
			light_vertex(p, &sky, i);
	}
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
