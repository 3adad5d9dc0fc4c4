#include "tests/lib/scenes/drawn_head.h"

#include <math.h>
#include <string.h>

#include "bridge/om_mesh.h"
#include "math/vec.h"

enum { EYE_FIRST = 4202 };  // vertices of the eyeballs come last

bool drawn_head_load(struct drawn_head *head, struct err *err)
{
	*head = (struct drawn_head){ .scene = 0 };
	struct mesh *m = &head->mesh;
	if (!om_mesh_load(m, "samples/face/targets/mpfb.obj", 100000, err))
		return false;
	for (int i = 0; i < m->n_vertices; i++)
		for (int k = 0; k < 3; k++)
			m->vertices[i][k] *= 100;
	head->scene = ray_scene_new(m->n_vertices, (const float(*)[3])m->vertices, m->n_faces, (const int32_t(*)[3])m->faces);
	return true;
}

void drawn_head_free(struct drawn_head *head)
{
	ray_scene_free(head->scene);
	mesh_free(&head->mesh);
}

void drawn_head_camera(double R[3][3], double t[3], double yaw, double pitch, double distance)
{
	const double middle[3] = { 0, 715, 100 }, down[3] = { 0, -1, 0 };
	double out[3] = { sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch) }, center[3];
	vec_add(center, middle, distance, out);
	for (int k = 0; k < 3; k++)
		R[2][k] = -out[k];
	vec_cross(R[0], down, R[2]);
	vec_unit(R[0], R[0]);
	vec_cross(R[1], R[2], R[0]);
	for (int k = 0; k < 3; k++)
		t[k] = -vec_dot(R[k], center);
}

/* 0..1 at a corner of a lattice. */
static double hash(int x, int y, int z)
{
	uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu;
	h = (h ^ h >> 15) * 0x2c1b3c6du;
	h = (h ^ h >> 12) * 0x297a2d39u;
	return (h ^ h >> 15) / 4294967296.0;
}

/* Blotches of so many mm. */
static double noise(const double p[3], double size)
{
	double sum = 0, f[3];
	int c[3];
	for (int k = 0; k < 3; k++) {
		c[k] = (int)floor(p[k] / size);
		f[k] = p[k] / size - c[k];
		f[k] = f[k] * f[k] * (3 - 2 * f[k]);
	}
	for (int i = 0; i < 8; i++)
		sum += (i & 1 ? f[0] : 1 - f[0]) * (i & 2 ? f[1] : 1 - f[1]) * (i & 4 ? f[2] : 1 - f[2]) * hash(c[0] + (i & 1), c[1] + (i >> 1 & 1), c[2] + (i >> 2));
	return sum;
}

static void albedo(double rgb[3], const double p[3], bool of_eye)
{
	static const double skin[3] = { 0.62, 0.42, 0.32 }, lips[3] = { 0.45, 0.2, 0.18 }, hair[3] = { 0.1, 0.07, 0.05 }, white[3] = { 0.8, 0.78, 0.75 },
	                    iris[3] = { 0.06, 0.09, 0.12 }, pupil[3] = { 0.01, 0.01, 0.01 };
	const double side = fabs(p[0]), off = hypot(side - drawn_head_ball[0][0], p[1] - drawn_head_ball[0][1]);
	const bool brow = p[2] > 60 && fabs(p[1] - 751) < 4 && fabs(side - 29) < 24, mouth = p[2] > 90 && hypot(p[0] / 26, (p[1] - 661) / 7) < 1;
	const double *colour = of_eye ? off < 2.2 ? pupil : off < DRAWN_HEAD_IRIS ? iris : white : brow || p[1] > 800 ? hair : mouth ? lips : skin;
	// Freckles and pores: what pictures are compared by.
	double mark = of_eye ? 1 : 0.6 + 0.3 * noise(p, 5) + 0.3 * noise(p, 1.8) + 0.2 * noise(p, 0.8);
	for (int k = 0; k < 3; k++)
		rgb[k] = colour[k] * mark;
}

static void shade(uint8_t rgb[3], const struct drawn_head *head, const float eye[3], const float dir[3])
{
	const struct mesh *m = &head->mesh;
	struct ray_hit hit = ray_first(head->scene, eye, dir, 0, 1e4f);
	if (hit.face < 0) {
		memset(rgb, 130, 3);
		return;
	}
	const int32_t *f = m->faces[hit.face];
	double a[3], b[3], n[3], p[3], c[3], light[3] = { 0.2, 0.5, 1 };
	for (int k = 0; k < 3; k++) {
		a[k] = m->vertices[f[1]][k] - m->vertices[f[0]][k];
		b[k] = m->vertices[f[2]][k] - m->vertices[f[0]][k];
		p[k] = eye[k] + hit.t * dir[k];
	}
	vec_cross(n, a, b);
	vec_unit(n, n);
	vec_unit(light, light);
	albedo(c, p, f[0] >= EYE_FIRST);
	double lit = 0.3 + 0.7 * fmax(0, vec_dot(n, light));
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(255 * pow(fmin(1, c[k] * lit), 1 / 2.2) + 0.5);
}

void drawn_head_draw(uint8_t *rgb, const struct drawn_head *head, const double R[3][3], const double t[3], double focal_px, int width, int height)
{
	double center[3];
	mat_tvec(center, R, t);
	const float eye[3] = { (float)-center[0], (float)-center[1], (float)-center[2] };
#pragma omp parallel for
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const double c[3] = { (x + 0.5 - 0.5 * width) / focal_px, (y + 0.5 - 0.5 * height) / focal_px, 1 };
			double d[3];
			mat_tvec(d, R, c);
			shade(rgb + 3 * ((long)y * width + x), head, eye, (const float[3]){ (float)d[0], (float)d[1], (float)d[2] });
		}
}
