/* Wrinkles of expressions on a character: the subject's bump maps, looked up where the modelling camera sees the skin at rest. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/model.h"
#include "draw/face/impl.h"
#include "draw/face/skin_look.h"

void portrait_wear(struct portrait *p, const struct wrinkle_maps *maps, int n_au, char *const au_names[])
{
	struct portrait_mesh *m = &p->mesh;
	free(p->wrinkle_input);
	free(p->wrinkle_strength);
	free(m->home);
	p->wrinkles = maps;
	p->wrinkle_input = mem_new((size_t)maps->n + 1, sizeof *p->wrinkle_input);
	p->wrinkle_strength = mem_new((size_t)maps->n + 1, sizeof *p->wrinkle_strength);
	for (int i = 0; i < maps->n; i++) {
		p->wrinkle_input[i] = -1;
		for (int k = 0; k < n_au; k++)
			if (!strcmp(maps->name[i], au_names[k]))
				p->wrinkle_input[i] = SKIN_EYE_INPUTS + k;
	}
	m->home = mem_new((size_t)m->n + 1, sizeof *m->home);
	memcpy(m->home, p->rig->home, (size_t)p->rig->n * sizeof *m->home);
	for (int i = m->n_base; i < m->n; i++)
		for (int c = 0; c < 2; c++)
			m->home[i][c] = 0.5f * (m->home[m->between[i - m->n_base][0]][c] + m->home[m->between[i - m->n_base][1]][c]);
}

void portrait_fold_pose(struct portrait *p, const double *controls)
{
	p->folded = false;
	for (int i = 0; p->wrinkles && i < p->wrinkles->n; i++) {
		int k = p->wrinkle_input[i];
		p->wrinkle_strength[i] = k < 0 ? 0 : (float)fmin(1, fmax(0, controls[k]));
		p->folded = p->folded || (p->wrinkles->folds[i] && p->wrinkle_strength[i] > 0);
	}
}

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Turns a slope in the chart into a gradient on the face; grooves scale with the character. */
static bool on_face(float g[3], const struct portrait *p, int face, const float slope[2])
{
	const struct portrait_mesh *m = &p->mesh;
	const int32_t *v = m->faces[face];
	float e[2][3], h[2][2], rise[2];
	for (int k = 0; k < 2; k++) {
		for (int c = 0; c < 3; c++)
			e[k][c] = m->x[v[k + 1]][c] - m->x[v[0]][c];
		for (int c = 0; c < 2; c++)
			h[k][c] = m->home[v[k + 1]][c] - m->home[v[0]][c];
		rise[k] = slope[0] * h[k][0] + slope[1] * h[k][1];
	}
	float a = dot(e[0], e[0]), b = dot(e[0], e[1]), c = dot(e[1], e[1]), det = a * c - b * b;
	float seen = h[0][1] * h[1][0] - h[0][0] * h[1][1];  // the chart's y points down: > 0 where the camera sees its front
	if (!(det > 1e-12f) || !(seen > 0))
		return false;
	float s = (rise[0] * c - rise[1] * b) / det, t = (rise[1] * a - rise[0] * b) / det, area = sqrtf(det);
	const double *row = p->rig->camera.from_target[0];
	float subject_mm = (float)sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);  // in one of the character's
	for (int k = 0; k < 3; k++)
		g[k] = (s * e[0][k] + t * e[1][k]) / subject_mm;
	float px = (float)p->wrinkles->px_per_mm * subject_mm;
	return seen > 0.1f * px * px * area;  // a face that the camera sees nearly edge-on shows no lines
}

bool portrait_fold(float normal[3], float light[3], const struct portrait *p, const struct portrait_sky *sky, int face, const float w[3])
{
	const struct portrait_mesh *m = &p->mesh;
	const int32_t *v = m->faces[face];
	float px[2], slope[2], open, g[3], bent[3], before[3] = { 0 }, after[3] = { 0 };
	for (int c = 0; c < 2; c++)
		px[c] = w[0] * m->home[v[0]][c] + w[1] * m->home[v[1]][c] + w[2] * m->home[v[2]][c];
	if (!wrinkle_maps_at(slope, &open, p->wrinkles, p->wrinkle_strength, px) || !on_face(g, p, face, slope))
		return false;
	for (int c = 0; c < 3; c++)
		bent[c] = normal[c] - (float)SKIN_FOLD_DIFFUSE * g[c];
	float len = sqrtf(dot(bent, bent));
	for (int k = 0; k < sky->n; k++)
		for (int c = 0; c < 3; c++) {
			before[c] += sky->light[k].rgb[c] * fmaxf(0, dot(normal, sky->light[k].dir));
			after[c] += sky->light[k].rgb[c] * fmaxf(0, dot(bent, sky->light[k].dir)) / len;
		}
	for (int c = 0; c < 3; c++) {
		light[c] *= open * (before[c] > 0 ? fminf(2, after[c] / before[c]) : 1);
		normal[c] -= g[c];
	}
	len = sqrtf(dot(normal, normal));
	for (int c = 0; c < 3; c++)
		normal[c] /= len;
	return true;
}
