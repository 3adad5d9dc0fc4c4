#include "tests/lib/scenes/wrinkle_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"

enum { W = SCENE_W, H = SCENE_H, GRID = 16, N = GRID * GRID, MESH = 61, AZIMUTHS = 20, TILTS = 10 };

static const double ball = scene_ball, away = scene_away, focal = scene_focal;

const struct groove scene_grooves[GROOVES] = {
	{ { -8, -12 }, 20, 1.0, 2.0, 0.28, 0.32 },
	{ { 6, 22 }, 26, -1.9, -1.2, 0.20, 0.22 },
	{ { 30, 0 }, 18, 2.7, 3.6, 0.40, 0.50 },
};

double scene_height(double x, double y, double strength)
{
	double h = 0;
	for (int i = 0; i < GROOVES; i++) {
		const struct groove *g = &scene_grooves[i];
		double u = x - g->center[0], v = y - g->center[1], s = sqrt(u * u + v * v) - g->radius, angle;
		if (fabs(s) > 6 * g->width)
			continue;
		angle = atan2(v, u);
		angle += angle < g->from - M_PI ? 2 * M_PI : 0;
		double beyond = g->radius * fmax(0, fmax(g->from - angle, angle - g->to));
		h -= strength * g->depth * exp(-0.5 * (s * s + beyond * beyond) / (g->width * g->width));
	}
	return h;
}

/* A head that looks into the camera: x right in the picture is the head's x, y up, z towards the camera. */
static const double cam_from_head[4][4] = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, 490 }, { 0, 0, 0, 1 } };
static const struct camera camera = { .focal_px = 3400, .center_px = { W / 2.0, H / 2.0 } };

/* Point of the ball that a px shows; NAN beside it. */
static void on_ball(double p[3], const double px[2])
{
	double dir[3] = { (px[0] - W / 2.0) / focal, -(px[1] - H / 2.0) / focal, -1 }, from = ball + away;
	double a = vec_dot(dir, dir), b = from * dir[2], c = from * from - ball * ball, t = (-b - sqrt(b * b - a * c)) / a;
	for (int k = 0; k < 3; k++)
		p[k] = t * dir[k] + (k == 2 ? from : 0);
}

/* Share of the light on a place of the relief, by rays. */
static double lit(const double p[3], double strength, const struct scene_light *light)
{
	const double step = 1e-3;
	double h = scene_height(p[0], p[1], strength), n[3], sum = 0;
	double dx = (scene_height(p[0] + step, p[1], strength) - h) / step, dy = (scene_height(p[0], p[1] + step, strength) - h) / step;
	n[0] = p[0] / ball - dx, n[1] = p[1] / ball - dy, n[2] = p[2] / ball;
	vec_unit(n, n);
	double near = fabs(scene_height(p[0], p[1], strength)) + fabs(dx) + fabs(dy);
	if (near < 1e-4)
		return light->sky + fmax(0, vec_dot(light->lamp, n));
	for (int a = 0; a < AZIMUTHS; a++) {
		double phi = 2 * M_PI * (a + 0.5) / AZIMUTHS, u = cos(phi), v = sin(phi), horizon = 0;
		for (double d = 0.05; d < 3; d *= 1.15)
			horizon = fmax(horizon, (scene_height(p[0] + d * u, p[1] + d * v, strength) - h) / d);
		double open = atan2(1, horizon), m[3] = { -dx, -dy, 1 };
		vec_unit(m, m);
		for (int k = 0; k < TILTS; k++) {
			double theta = open * (k + 0.5) / TILTS, cosine = m[2] * cos(theta) + (m[0] * u + m[1] * v) * sin(theta);
			sum += fmax(0, cosine) * sin(theta) * open / TILTS;
		}
	}
	return light->sky * sum * 2 / AZIMUTHS + fmax(0, vec_dot(light->lamp, n));
}

static double waves(double x, double y)
{
	double v = 0;
	for (int i = 0; i < 14; i++) {
		double k = 2 * M_PI / (1.2 * pow(1.25, i)), angle = 2.4 * i;
		v += 0.006 * cos(k * (x * cos(angle) + y * sin(angle)) + 1.7 * i);
	}
	return v;
}

/* Skin is patterned; a mole; hairs of a brow along the upper rim, dark as no groove is. */
static double albedo(double x, double y)
{
	double a = 0.45 * (1 + waves(x, y)), hair = 0;
	a *= 1 - 0.6 * exp(-0.5 * (pow(x - 9, 2) + pow(y + 7, 2)) / 0.3);
	if (y > 9.5)
		hair = 0.35 * pow(0.5 + 0.5 * cos(6 * x + 9 * y), 4) * fmin(1, y - 9.5);
	return a * (1 - hair);
}

/* Where a px of the reference is in frame k: turned, stretched, shifted. */
static void moved(double out[2], const double px[2], double share)
{
	double u = px[0] - W / 2.0, v = px[1] - H / 2.0;
	out[0] = W / 2.0 + (1 + 0.02 * share) * u + 0.03 * share * v + 5.3 * share;
	out[1] = H / 2.0 - 0.03 * share * u + (1 - 0.03 * share) * v - 7.7 * share;
}

static void unmoved(double out[2], const double px[2], double share)
{
	double a = 1 + 0.02 * share, b = 0.03 * share, c = -0.03 * share, d = 1 - 0.03 * share, det = a * d - b * c;
	double u = px[0] - W / 2.0 - 5.3 * share, v = px[1] - H / 2.0 + 7.7 * share;
	out[0] = W / 2.0 + (d * u - b * v) / det;
	out[1] = H / 2.0 + (a * v - c * u) / det;
}

static void photograph(uint8_t *grey, double share, double strength, const struct scene_light *light, uint64_t seed)
{
	struct rng rng = { seed };
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double px[2], p[3];
			unmoved(px, (double[]){ x + 0.5, y + 0.5 }, share);
			on_ball(p, px);
			double v = albedo(p[0], p[1]) * lit(p, strength * share, light), noise = rng_uniform(&rng) + rng_uniform(&rng) - 1;
			grey[y * W + x] = (uint8_t)fmax(0, fmin(255, round(255 * (double)srgb_from_linear((float)v) + 2 * noise)));
		}
}

static void build_mesh(struct scene *s)
{
	s->mesh = (struct mesh){ .n_vertices = MESH * MESH, .n_faces = 2 * (MESH - 1) * (MESH - 1) };
	s->mesh.vertices = mem_new(MESH * MESH, sizeof *s->mesh.vertices);
	s->mesh.faces = mem_new((size_t)s->mesh.n_faces, sizeof *s->mesh.faces);
	for (int j = 0, f = 0; j < MESH; j++)
		for (int i = 0; i < MESH; i++) {
			double x = 50.0 * i / (MESH - 1) - 25, y = 40.0 * j / (MESH - 1) - 20;
			float *v = s->mesh.vertices[j * MESH + i];
			v[0] = (float)x, v[1] = (float)y, v[2] = (float)sqrt(ball * ball - x * x - y * y);
			if (i + 1 == MESH || j + 1 == MESH)
				continue;
			int32_t a = j * MESH + i;
			memcpy(s->mesh.faces[f++], (int32_t[]){ a, a + 1, a + MESH }, sizeof *s->mesh.faces);
			memcpy(s->mesh.faces[f++], (int32_t[]){ a + 1, a + MESH + 1, a + MESH }, sizeof *s->mesh.faces);
		}
	s->normals = mesh_normals(&s->mesh);
	s->rays = ray_scene_new(s->mesh.n_vertices, (const float(*)[3])s->mesh.vertices, s->mesh.n_faces, (const int32_t(*)[3])s->mesh.faces);
}

void scene_open(struct scene *s, double strength, const struct scene_light *light)
{
	*s = (struct scene){ .ref = mem_new(N, sizeof *s->ref), .confidence = mem_new(N, sizeof *s->confidence), .mask = mem_new(W * H, 1) };
	build_mesh(s);
	memset(s->mask, 255, W * H);
	for (int i = 0; i < N; i++) {
		s->ref[i][0] = 12 + (W - 24.0) * (i % GRID) / (GRID - 1);
		s->ref[i][1] = 12 + (H - 24.0) * (double)(i / GRID) / (GRID - 1);
		s->confidence[i] = 1;
	}
	for (int k = 0; k < SCENE_FRAMES; k++) {
		double share = (double)k / (SCENE_FRAMES - 1);
		s->grey[k] = mem_new(W * H, 1);
		s->at[k] = mem_new(N, sizeof *s->at[k]);
		photograph(s->grey[k], share, strength, light, 3 + (uint64_t)k);
		for (int i = 0; i < N; i++) {
			double px[2];
			moved(px, s->ref[i], share);
			s->at[k][i][0] = (float)px[0];
			s->at[k][i][1] = (float)px[1];
		}
		s->frame[k] = (struct wrinkle_frame){ 10 + k, s->grey[k], (const float(*)[2])s->at[k], s->confidence };
	}
	s->ground = (struct wrinkle_ground){ 0, 0, W, H, focal / away, N, (const double(*)[2])s->ref, s->mask, &s->mesh, (const float(*)[3])s->normals, s->rays, &camera, cam_from_head };
}

void scene_close(struct scene *s)
{
	for (int k = 0; k < SCENE_FRAMES; k++) {
		free(s->grey[k]);
		free(s->at[k]);
	}
	free(s->ref);
	free(s->confidence);
	free(s->mask);
	free(s->normals);
	ray_scene_free(s->rays);
	mesh_free(&s->mesh);
}

