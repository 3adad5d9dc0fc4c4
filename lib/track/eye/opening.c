#include "track/eye/opening.h"

#include <math.h>
#include <string.h>

#include "math/vec.h"

enum { DIRECTIONS = 256, STEPS = 90, HALVINGS = 12 };

struct view {
	const struct ray_scene *mesh;
	double from[3], center[3], radius;
	double axis[3], right[3], up[3];  // towards `from`; across
};

/* The eyeball's point at angle `off` from the axis, in direction phi about it. */
static void on_globe(double out[3], const struct view *v, double off, double phi)
{
	for (int k = 0; k < 3; k++)
		out[k] = v->center[k]
		         + v->radius * (cos(off) * v->axis[k] + sin(off) * (cos(phi) * v->right[k] + sin(phi) * v->up[k]));
}

/* True when the mesh hides that point; edge: the point that hides it. */
static bool hidden(double edge[3], const struct view *v, double off, double phi)
{
	double p[3], dir[3];
	on_globe(p, v, off, phi);
	for (int k = 0; k < 3; k++)
		dir[k] = p[k] - v->from[k];
	const float from[3] = { (float)v->from[0], (float)v->from[1], (float)v->from[2] };
	const float to[3] = { (float)dir[0], (float)dir[1], (float)dir[2] };
	struct ray_hit hit = ray_first(v->mesh, from, to, 0, 1);
	if (hit.face < 0)
		return false;
	vec_add(edge, v->from, hit.t, dir);
	return true;
}

/* The first point of the mesh that hides the eyeball going outwards. Returns false when none does. */
static bool outward(double edge[3], const struct view *v, double phi)
{
	const double end = 1.5;
	double low = 0, high = 0;
	for (int i = 1; i <= STEPS && high <= 0; i++) {
		double off = end * i / STEPS;
		if (hidden(edge, v, off, phi))
			high = off;
		else
			low = off;
	}
	for (int i = 0; i < HALVINGS && high > 0; i++) {
		double mid = 0.5 * (low + high);
		if (hidden(edge, v, mid, phi))
			high = mid;
		else
			low = mid;
	}
	return high > 0;
}

/* OPENING_POINTS evenly along the closed outline. */
static void spread(double out[OPENING_POINTS][3], double edge[DIRECTIONS][3])
{
	double along[DIRECTIONS + 1] = { 0 };
	for (int i = 0; i < DIRECTIONS; i++) {
		const double *a = edge[i], *b = edge[(i + 1) % DIRECTIONS];
		along[i + 1] = along[i] + sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
	}
	for (int k = 0, i = 0; k < OPENING_POINTS; k++) {
		double to = along[DIRECTIONS] * k / OPENING_POINTS;
		while (i < DIRECTIONS - 1 && along[i + 1] <= to)
			i++;
		double t = (to - along[i]) / fmax(along[i + 1] - along[i], 1e-12);
		for (int c = 0; c < 3; c++)
			out[k][c] = (1 - t) * edge[i][c] + t * edge[(i + 1) % DIRECTIONS][c];
	}
}

void eye_opening_find(struct eye_opening *o, const struct ray_scene *mesh, const double from[3], const double center[3], double radius)
{
	struct view v = { .mesh = mesh, .radius = radius };
	double edge[DIRECTIONS][3], up[3] = { 0, 1, 0 };
	*o = (struct eye_opening){ 0 };
	for (int k = 0; k < 3; k++) {
		v.from[k] = from[k];
		v.center[k] = center[k];
		v.axis[k] = from[k] - center[k];
	}
	vec_unit(v.axis, v.axis);
	vec_cross(v.right, up, v.axis);
	vec_unit(v.right, v.right);
	vec_cross(v.up, v.axis, v.right);
	if (hidden(edge[0], &v, 0, 0))
		return;
	for (int i = 0; i < DIRECTIONS; i++)
		if (!outward(edge[i], &v, 2 * M_PI * i / DIRECTIONS))
			return;
	o->open = true;
	spread(o->edge, edge);
	int nose = 0, temple = 0;
	double side = center[0] < 0 ? -1 : 1;
	for (int i = 0; i < DIRECTIONS; i++) {
		nose = side * edge[i][0] < side * edge[nose][0] ? i : nose;
		temple = side * edge[i][0] > side * edge[temple][0] ? i : temple;
	}
	memcpy(o->canthus[0], edge[nose], sizeof o->canthus[0]);
	memcpy(o->canthus[1], edge[temple], sizeof o->canthus[1]);
	for (int i = 0; i < OPENING_POINTS; i++)
		vec_add(o->center, o->center, 1.0 / OPENING_POINTS, o->edge[i]);
}
