/* The chart of a rig: where the modelling camera sees the character, and the skull map over it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/ray.h"
#include "rig/make/make_impl.h"

static void *fresh(int n, size_t size)
{
	return mem_new((size_t)n + 1, size);
}

/* With the lens's distortion, which the tracked points contain, too. */
void rig_project(double px[2], double cam[3], const struct skin_camera *c, const float x[3])
{
	for (int i = 0; i < 3; i++)
		cam[i] = c->cam_from_head[i][0] * x[0] + c->cam_from_head[i][1] * x[1] + c->cam_from_head[i][2] * x[2] + c->cam_from_head[i][3];
	const double *k = c->distortion;
	double u = cam[0] / cam[2], v = cam[1] / cam[2], r2 = u * u + v * v;
	double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
	px[0] = c->focal_px * (u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u)) + c->center_px[0];
	px[1] = c->focal_px * (v * radial + k[2] * (r2 + 2 * v * v) + 2 * k[3] * u * v) + c->center_px[1];
}

void rig_take_homes(struct rig *rig, const struct rig_motion *m, const struct rig_character *ch)
{
	for (int i = 0; i < rig->n; i++) {
		double px[2], cam[3];
		rig_project(px, cam, &m->camera, ch->registered[i]);
		bool ahead = cam[2] > 1e-6 && isfinite(px[0]) && isfinite(px[1]);
		for (int k = 0; k < 2; k++)
			rig->home[i][k] = ahead ? (float)fmin(fmax(px[k], -1e5), 1e5) : -1e5f;
	}
}

/* Marks skin that the modelling camera sees at rest: it faces the camera, and nothing lies in front. free(). */
static bool *visible_of(const struct rig *rig, const struct rig_motion *m, const struct rig_character *ch)
{
	bool *visible = fresh(rig->n, sizeof *visible);
	struct mesh mesh = { rig->n, rig->n_faces, (float(*)[3])(uintptr_t)ch->registered, rig->faces, 0 };
	struct ray_scene *scene = ray_scene_new(rig->n, ch->registered, rig->n_faces, (const int32_t(*)[3])rig->faces);
	float (*normal)[3] = mesh_normals(&mesh), eye[3];
	for (int j = 0; j < 3; j++) {
		eye[j] = 0;
		for (int i = 0; i < 3; i++)
			eye[j] -= (float)(m->camera.cam_from_head[i][j] * m->camera.cam_from_head[i][3]);
	}
	for (int i = 0; i < rig->n; i++) {
		float to[3], len = 0, facing = 0, from[3];
		for (int c = 0; c < 3; c++) {
			to[c] = eye[c] - ch->registered[i][c];
			len += to[c] * to[c];
			facing += to[c] * normal[i][c];
			from[c] = ch->registered[i][c] + 0.05f * normal[i][c];
		}
		len = sqrtf(len);
		visible[i] = rig->part[i] == RIG_SKIN && facing > 0.05f * len && !ray_blocked(scene, from, to, 0.3f / len, 1);
	}
	free(normal);
	ray_scene_free(scene);
	return visible;
}

/* The part of the picture that moving skin can reach: its bounding box at rest, with a border. px. */
static void reach_of(double box[4], const struct rig *rig)
{
	double span = 0;
	box[0] = box[1] = INFINITY;
	box[2] = box[3] = -INFINITY;
	for (int i = 0; i < rig->n; i++) {
		double most = 0;
		for (int k = 0; k < RIG_BASIS; k++)
			most = fmax(most, fabs(rig->basis[i][k]));
		if (!(most > 0) || rig->home[i][0] <= -1e5f)
			continue;
		for (int k = 0; k < 2; k++) {
			box[k] = fmin(box[k], rig->home[i][k]);
			box[k + 2] = fmax(box[k + 2], rig->home[i][k]);
		}
	}
	span = fmax(box[2] - box[0], box[3] - box[1]);
	for (int k = 0; k < 4; k++)
		box[k] += (k < 2 ? -0.08 : 0.08) * span;
}

bool rig_take_skull(struct rig *rig, const struct rig_motion *m, const struct rig_character *ch, double step, double smooth, struct err *err)
{
	double box[4], (*site)[2] = fresh(rig->n, sizeof *site);
	float (*position)[3] = fresh(rig->n, sizeof *position), (*normal)[3] = fresh(rig->n, sizeof *normal);
	bool *visible = visible_of(rig, m, ch);
	int n = 0;
	reach_of(box, rig);
	double margin = 0.1 * (box[2] - box[0]);
	for (int i = 0; i < rig->n; i++) {
		const float *h = rig->home[i];
		if (!visible[i] || h[0] < box[0] - margin || h[0] > box[2] + margin || h[1] < box[1] - margin || h[1] > box[3] + margin)
			continue;
		for (int c = 0; c < 3; c++) {
			if (c < 2)
				site[n][c] = h[c];
			position[n][c] = rig->rest[i][c];
			normal[n][c] = rig->normal[i][c];
		}
		n++;
	}
	bool ok = n >= 3 || err_set(err, "none of the skin that moves is in the modelling camera's view: the character is not registered "
	                            "on the subject");
	ok = ok && skull_map_make(&rig->skull, n, (const double(*)[2])site, (const float(*)[3])position, (const float(*)[3])normal,
	                          box, step, err);
	if (ok)
		skull_map_smooth(&rig->skull, smooth);
	free(visible);
	free(site);
	free(position);
	free(normal);
	return ok;
}
