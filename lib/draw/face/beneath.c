/* Light on an eye below lids and lashes: each direction of the environment that they leave, and what the lids' skin sends. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/face/impl.h"
#include "draw/face/sky.h"
#include "math/vec.h"

enum { RAYS = 16 };  // that look for skin
static const float lift_mm = 0.02f, far_mm = 120, skin_mm = 60;
static const float white_over_iris = 5;  // their radiances, about
static const double beyond_mm = 0.1;  // the limbus lets light in (draw/eye/rim_edge.h), and is less deep by about as much

struct portrait_beneath {
	const struct portrait *p;
	const struct scene *scene;
	struct portrait_fringe *fringe;
	int side, n;
	struct envmap_light light[ENVMAP_LIGHTS_MAX];
	double toward[ENVMAP_LIGHTS_MAX][3];  // those directions in the eye's frame
	double axes[3][3], scale;             // rig_from_eye, mm of the rig in one of the eye's
	double cap;                           // radius of the cornea as a sphere, mm of the eye
};

struct portrait_beneath *portrait_beneath_new(const struct portrait *p, const struct portrait_rays *rays, int side)
{
	struct portrait_beneath *b = mem_new(1, sizeof *b);
	b->p = p;
	b->scene = p->eye[side];
	b->side = side;
	portrait_eye_axes(b->axes, p, side);
	b->scale = portrait_eye_scale(p, side);
	b->cap = portrait_eye_cap(b->scene);
	b->n = portrait_lights(b->light, 2 * p->conf.lights, p, rays);
	for (int k = 0; k < b->n; k++)
		mat_tvec(b->toward[k], b->axes, (double[]){ b->light[k].dir[0], b->light[k].dir[1], b->light[k].dir[2] });
	b->fringe = portrait_fringe_new(p, side, false, b->n, b->light);
	return b;
}

void portrait_beneath_free(struct portrait_beneath *b)
{
	if (b)
		portrait_fringe_free(b->fringe);
	free(b);
}

/* A place of the eye's frame in the rig's. */
static void to_rig(float out[3], const struct portrait_beneath *b, const double x[3])
{
	double v[3] = { x[0], x[1], x[2] - b->scene->sclera_z };
	mat_vec(v, b->axes, v);
	for (int c = 0; c < 3; c++)
		out[c] = (float)(b->p->rig->globe[b->side].center[c] + b->scale * v[c]);
}

/* Where a ray from a place of the iris plane in direction `in` (unit) leaves the cornea, and the unit normal there. False: it does not. */
static bool leave(double e[3], double n[3], const struct portrait_beneath *b, const double within[3], const double in[3])
{
	const double q[3] = { within[0], within[1], within[2] - b->cap }, half = vec_dot(q, in), disc = b->cap * b->cap - vec_dot(q, q) + half * half;
	if (disc < 0)
		return false;
	vec_add(e, within, sqrt(disc) - half, in);
	vec_add(n, e, -1, (double[]){ 0, 0, b->cap });
	vec_unit(n, n);
	return true;
}

/* The direction behind the cornea of light from `toward` at a place of the iris plane, and where it enters: each is found from the other. False: it does not come
 * there. */
static bool meet(double e[3], double in[3], double *cosine, const struct portrait_beneath *b, const double within[3], const double toward[3])
{
	double n[3];
	memcpy(in, (double[3]){ 0, 0, -1 }, 3 * sizeof *in);
	for (int round = 0; round < 5; round++) {
		if (!leave(e, n, b, within, in))
			return false;
		portrait_eye_bend(in, cosine, toward, n, b->scene->eye.index);
	}
	return *cosine > 0 && e[2] <= b->scene->limbus_depth + beyond_mm;
}

/* Where light of that direction goes into the cornea to come to a place of the iris plane (rig's frame), and what it counts for there: its cosine with the plane, what
 * Fresnel lets through, and by how much it is closer together behind the cornea, where radiance is index^2 times as much. */
static float enter(float at[3], const struct portrait_beneath *b, const double within[3], const double toward[3])
{
	static const double little = 0.01;
	double e[3], in[3], c, across[2][3], aside[2][3];
	if (!meet(e, in, &c, b, within, toward) || in[2] > 0)
		return 0;
	vec_cross(across[0], toward, fabs(toward[0]) < 0.6 ? (double[]){ 1, 0, 0 } : (double[]){ 0, 1, 0 });
	vec_unit(across[0], across[0]);
	vec_cross(across[1], toward, across[0]);
	for (int k = 0; k < 2; k++) {
		double to[3], where[3], cosine;
		vec_add(to, toward, little, across[k]);
		vec_unit(to, to);
		if (!meet(where, aside[k], &cosine, b, within, to))
			return 0;
		vec_add(aside[k], aside[k], -1, in);
	}
	double closer[3];
	vec_cross(closer, aside[0], aside[1]);
	to_rig(at, b, e);
	return (float)(b->scene->eye.index * b->scene->eye.index * vec_norm(closer) / (little * little) * -in[2]) * (1 - portrait_film_share((float)c));
}

/* Light that skin sends from where a ray meets it, over pi. */
static bool skin_at(float rgb[3], const struct portrait_beneath *b, const float at[3], const float dir[3])
{
	return portrait_skin_light(rgb, b->p, (const float(*)[3])b->p->mesh.light, at, dir, lift_mm, skin_mm);
}

/* Where light of a direction goes in to what is seen at a spot, and what it counts for, its cosine included. */
static float way_in(float from[3], const struct portrait_beneath *b, const struct portrait_eye_spot *spot, bool through, const float dir[3], const double toward[3])
{
	if (through)
		return enter(from, b, spot->within, toward);
	const float c = dir[0] * spot->normal[0] + dir[1] * spot->normal[1] + dir[2] * spot->normal[2];
	for (int i = 0; i < 3; i++)
		from[i] = spot->at[i];
	return c > 0 ? c * (1 - portrait_film_share(c)) : 0;
}

/* The ray that comes out of the eye where one leaves what is seen at a spot in a direction of the fan about its normal, and what light that comes in along it counts
 * for, over that cosine. */
static float way_out(float from[3], float dir[3], const struct portrait_beneath *b, const struct portrait_eye_spot *spot, bool through, const struct portrait_fan *fan, int k)
{
	const float z = portrait_fan_ray(dir, fan, k, RAYS);
	if (!through) {
		for (int i = 0; i < 3; i++)
			from[i] = spot->at[i];
		return 1 - portrait_film_share(z);
	}
	const double index = b->scene->eye.index, in[3] = { dir[0], dir[1], dir[2] };
	double e[3], n[3], out[3];
	if (!leave(e, n, b, spot->within, in) || e[2] > b->scene->limbus_depth + beyond_mm)
		return 0;
	const double c = vec_dot(in, n), aside2 = index * index * (1 - c * c);
	if (aside2 >= 1)
		return 0;
	for (int i = 0; i < 3; i++)
		out[i] = index * (in[i] - c * n[i]) + sqrt(1 - aside2) * n[i];
	to_rig(from, b, e);
	mat_vec(out, b->axes, out);
	for (int i = 0; i < 3; i++)
		dir[i] = (float)out[i];
	return (float)(index * index) * (1 - portrait_film_share((float)sqrt(1 - aside2)));
}

/* Adds to sum what skin about a place sends it. */
static void add_skin(float sum[3], const struct portrait_beneath *b, const struct portrait_eye_spot *spot, bool through)
{
	const struct portrait_fan fan = portrait_fan_of(through ? (float[]){ 0, 0, -1 } : spot->normal);
	for (int k = 0; k < RAYS; k++) {
		float dir[3], rgb[3], from[3];
		const float w = way_out(from, dir, b, spot, through, &fan, k);
		if (!(w > 0) || !skin_at(rgb, b, from, dir))
			continue;
		for (int c = 0; c < 3; c++)
			sum[c] += w / RAYS * rgb[c];
	}
}

/* Of the iris seen at a spot (through), or of its white. */
static void light_of(float share[3], const struct portrait_beneath *b, const struct portrait_eye_spot *spot, bool through)
{
	float sum[3] = { 0 }, all[3] = { 0 };
	for (int k = 0; k < b->n; k++) {
		const float *d = b->light[k].dir;
		float from[3];
		const float w = way_in(from, b, spot, through, d, b->toward[k]);
		if (!(w > 0))
			continue;
		for (int c = 0; c < 3; c++)
			all[c] += w * b->light[k].rgb[c];
		if (ray_blocked(b->p->shadow, from, d, lift_mm, far_mm))
			continue;
		const float left = portrait_fringe_through(b->fringe, k, from);
		for (int c = 0; c < 3; c++)
			sum[c] += w * left * b->light[k].rgb[c];
	}
	add_skin(sum, b, spot, through);
	for (int c = 0; c < 3; c++)
		share[c] = fminf(sum[c] / fmaxf(all[c], 0.02f), 2);
}

void portrait_beneath_light(float share[3], const struct portrait_beneath *b, const struct portrait_eye_spot *spot)
{
	// Where both are seen the white is the brighter by far: it tells the shade of both.
	const float part = spot->white * white_over_iris / (1 + spot->white * (white_over_iris - 1));
	float white[3] = { 0 }, iris[3] = { 0 };
	if (spot->white > 0)
		light_of(white, b, spot, false);
	if (spot->white < 1)
		light_of(iris, b, spot, true);
	for (int c = 0; c < 3; c++)
		share[c] = part * white[c] + (1 - part) * iris[c];
}

float portrait_beneath_mirrored(float rgb[3], const struct portrait_beneath *b, const struct portrait_eye_spot *spot, const float dir[3])
{
	const float *n = spot->normal, c = -(dir[0] * n[0] + dir[1] * n[1] + dir[2] * n[2]);
	float r[3];
	for (int i = 0; i < 3; i++)
		r[i] = dir[i] + 2 * c * n[i];
	if (skin_at(rgb, b, spot->at, r)) {
		for (int i = 0; i < 3; i++)
			rgb[i] *= portrait_film_share(c);
		return 0;
	}
	int nearest = 0;
	float most = -1;
	for (int k = 0; k < b->n; k++) {
		const float *d = b->light[k].dir, near = d[0] * r[0] + d[1] * r[1] + d[2] * r[2];
		nearest = near > most ? k : nearest;
		most = fmaxf(near, most);
	}
	for (int i = 0; i < 3; i++)
		rgb[i] = 0;
	return portrait_fringe_through(b->fringe, nearest, spot->at);
}
