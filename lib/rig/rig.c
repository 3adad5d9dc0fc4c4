#include "rig/rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/vec.h"

void rig_free(struct rig *rig)
{
	free(rig->faces);
	free(rig->W);
	free(rig->expression);
	free(rig->rest);
	free(rig->normal);
	free(rig->home);
	free(rig->basis);
	free(rig->fade);
	free(rig->bplus.start);
	free(rig->bplus.column);
	free(rig->bplus.weight);
	free(rig->thickness);
	free(rig->gap);
	free(rig->glue);
	free(rig->part);
	free(rig->source);
	free(rig->side);
	skull_map_free(&rig->skull);
	globe_map_free(&rig->globe[0].map);
	globe_map_free(&rig->globe[1].map);
	*rig = (struct rig){ 0 };
}

int rig_own_vertices(const struct rig *rig)
{
	int n = rig->n;
	while (n > 0 && rig->part[n - 1] == RIG_LINING)
		n--;
	return n;
}

int rig_own_faces(const struct rig *rig)
{
	int n = rig->n_faces;
	while (n > 0 && rig->part[rig->faces[n - 1][0]] == RIG_LINING)
		n--;
	return n;
}

void rig_components(double e[RIG_COMPONENTS], const struct rig *rig, const double *inputs)
{
	double gaze[2][3];
	for (int eye = 0; eye < 2; eye++) {
		memcpy(gaze[eye], inputs + 5 * eye, sizeof gaze[eye]);
		known_hold(gaze[eye], &rig->known, eye);
	}
	for (int k = 0; k < RIG_COMPONENTS; k++) {
		const double *row = rig->W + k * (rig->n_inputs + 1);
		e[k] = row[rig->n_inputs];
		for (int i = 0; i < rig->n_inputs; i++)
			e[k] += row[i] * (i < 10 && i % 5 < 3 ? gaze[i / 5][i % 5] : inputs[i]);
	}
}

/* Ry(h) Rx(-v) Rz(t) in the head's axes. */
static void fick(double m[3][3], const double gaze[3])
{
	double ch = cos(gaze[0]), sh = sin(gaze[0]), cv = cos(gaze[1]), sv = sin(gaze[1]), ct = cos(gaze[2]), st = sin(gaze[2]);
	double y[3][3] = { { ch, 0, sh }, { 0, 1, 0 }, { -sh, 0, ch } };
	double x[3][3] = { { 1, 0, 0 }, { 0, cv, sv }, { 0, -sv, cv } };
	double z[3][3] = { { ct, -st, 0 }, { st, ct, 0 }, { 0, 0, 1 } };
	mat_mul(m, y, x);
	mat_mul(m, m, z);
}

void rig_globe_rotation(double target_from_globe[3][3], const struct rig *rig, const double gaze[3])
{
	double turn[3][3], back[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			back[i][j] = rig->head_from_target[j][i];
	// The globe's own axes, in which D is stored, are the head's at rest.
	fick(turn, gaze);
	mat_mul(target_from_globe, back, turn);
}

void rig_globes_turned(double target_from_globe[2][3][3], const struct rig *rig, const double *controls)
{
	for (int s = 0; s < 2; s++) {
		double gaze[3];
		for (int k = 0; k < 3; k++)
			gaze[k] = controls[5 * s + k] * M_PI / 180;
		rig_globe_rotation(target_from_globe[s], rig, gaze);
	}
}

double rig_globe_distance(const struct rig *rig, int side, const double target_from_globe[3][3], const float x[3])
{
	const struct rig_globe *globe = &rig->globe[side];
	double d[3], r[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - globe->center[c];
	mat_tvec(r, target_from_globe, d);
	return vec_norm(d) - globe_map_at(&globe->map, (float[3]){ (float)r[0], (float)r[1], (float)r[2] });
}
