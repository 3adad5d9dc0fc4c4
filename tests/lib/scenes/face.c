#include "tests/lib/scenes/face.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"

enum { ACROSS = 97, UP = 49, RINGS = 24, SEGMENTS = 32, POINTS = 12 };
static const double half[2] = { 62, 28 }, pupil_distance = 62, fissure[2] = { 10, 4.5 }, distance = 600, focal = 5000;

static double lift(double x, double y)
{
	// Skin 1.5 mm before a globe of 12 mm, on a face that curves back.
	double z = 6 - 0.002 * x * x - 0.004 * y * y;
	for (int s = -1; s <= 1; s += 2) {
		double dx = x - s * pupil_distance / 2, r2 = 14.2 * 14.2 - dx * dx - y * y;
		if (r2 > 0)
			z = fmax(z, sqrt(r2));
	}
	return z;
}

static bool in_fissure(double x, double y)
{
	for (int s = -1; s <= 1; s += 2)
		if (hypot((x - s * pupil_distance / 2) / fissure[0], y / fissure[1]) < 1)
			return true;
	return false;
}

static void sheet(struct mesh *mesh, bool flat)
{
	mesh->vertices = mem_new(ACROSS * UP, sizeof *mesh->vertices);
	mesh->faces = mem_new(2 * ACROSS * UP, sizeof *mesh->faces);
	mesh->n_vertices = ACROSS * UP;
	for (int j = 0; j < UP; j++)
		for (int i = 0; i < ACROSS; i++) {
			double x = half[0] * (2.0 * i / (ACROSS - 1) - 1), y = half[1] * (2.0 * j / (UP - 1) - 1);
			float *v = mesh->vertices[j * ACROSS + i];
			v[0] = (float)x;
			v[1] = (float)y;
			v[2] = (float)(flat ? 12 : lift(x, y));
		}
	for (int j = 0; j + 1 < UP; j++)
		for (int i = 0; i + 1 < ACROSS; i++) {
			int a = j * ACROSS + i, b = a + 1, c = a + ACROSS, d = c + 1;
			const float *p = mesh->vertices[a];
			if (!flat && in_fissure(p[0] + 0.6, p[1] + 0.6))
				continue;
			memcpy(mesh->faces[mesh->n_faces++], (int32_t[]){ a, b, d }, sizeof *mesh->faces);
			memcpy(mesh->faces[mesh->n_faces++], (int32_t[]){ a, d, c }, sizeof *mesh->faces);
		}
}

/* A globe of 12 mm with a cornea of 7.8 whose apex is at 13.1. */
static void add_globe(struct mesh *mesh, const double center[3])
{
	int first = mesh->n_vertices;
	for (int j = 0; j <= RINGS; j++)
		for (int i = 0; i < SEGMENTS; i++) {
			double fall = M_PI * j / RINGS, turn = 2 * M_PI * i / SEGMENTS, z = cos(fall), shift = 13.1 - 7.8;
			double disc = 7.8 * 7.8 - shift * shift * (1 - z * z), r = fmax(12, z > 0 && disc > 0 ? shift * z + sqrt(disc) : 0);
			float *v = mesh->vertices[mesh->n_vertices++];
			v[0] = (float)(center[0] + r * sin(fall) * cos(turn));
			v[1] = (float)(center[1] + r * sin(fall) * sin(turn));
			v[2] = (float)(center[2] + r * z);
		}
	for (int j = 0; j < RINGS; j++)
		for (int i = 0; i < SEGMENTS; i++) {
			int a = first + j * SEGMENTS + i, b = first + j * SEGMENTS + (i + 1) % SEGMENTS;
			memcpy(mesh->faces[mesh->n_faces++], (int32_t[]){ a, a + SEGMENTS, b + SEGMENTS }, sizeof *mesh->faces);
			memcpy(mesh->faces[mesh->n_faces++], (int32_t[]){ a, b + SEGMENTS, b }, sizeof *mesh->faces);
		}
}

static void character(struct face *f)
{
	size_t n = ACROSS * UP + 2 * (RINGS + 1) * SEGMENTS;
	f->character.vertices = mem_new(n, sizeof *f->character.vertices);
	f->character.faces = mem_new((size_t)f->skin.n_faces + 4 * RINGS * SEGMENTS, sizeof *f->character.faces);
	f->character.n_vertices = f->skin.n_vertices;
	f->character.n_faces = f->skin.n_faces;
	memcpy(f->character.vertices, f->skin.vertices, (size_t)f->skin.n_vertices * sizeof *f->skin.vertices);
	memcpy(f->character.faces, f->skin.faces, (size_t)f->skin.n_faces * sizeof *f->skin.faces);
	for (int s = 0; s < 2; s++)
		add_globe(&f->character, f->center[s]);
	f->b_start = mem_new(n + 1, sizeof *f->b_start);
	f->b_column = mem_new(n, sizeof *f->b_column);
	f->b_weight = mem_new(n, sizeof *f->b_weight);
	for (int i = 0; i < (int)n; i++) {
		bool own = i < f->skin.n_vertices;
		f->b_column[i] = own ? i : 0;
		f->b_weight[i] = 1;
		f->b_start[i + 1] = own ? i + 1 : f->skin.n_vertices;
	}
}

static void see(double px[2], const float x[3])
{
	px[0] = focal * x[0] / (distance - x[2]) + 640;
	px[1] = -focal * x[1] / (distance - x[2]) + 360;
}

/* Lids: the fissure's outline. Component k of the lids moves the upper (k even) or lower lid of an eye up and down; the
 * others are noise. Skin: components translate and stretch the picture, so that the whole chain is an affine map. */
static void lids(struct skin_model *m)
{
	for (int lid = 0; lid < SKIN_LIDS; lid++)
		for (int i = 0; i < POINTS; i++) {
			double t = M_PI * i / (POINTS - 1), side = lid < 2 ? 1 : -1;
			float at[3] = { (float)(side * (pupil_distance / 2 - fissure[0] * cos(t))), (float)((lid % 2 ? -1 : 1) * fissure[1] * sin(t)) };
			at[2] = (float)lift(at[0], at[1]);
			int row = 2 * (lid * POINTS + i);
			see(m->l0 + row, at);
			for (int k = 0; k < SKIN_LIDS; k++)
				m->K[(row + 1) * m->n_lid_pc + k] = lid == k ? sin(t) : 0;
		}
	for (int k = 0; k < SKIN_LIDS; k++) {  // g4 and g9 raise the upper lids, g5 and g10 lower the lower ones
		int input = k < 2 ? 3 + k : 6 + k;
		m->L[k * (SKIN_EYE_INPUTS + 1) + input] = k % 2 ? 1 : -1;
		m->closed[input] = k % 2 ? 0 : -60;
		m->open[input] = k % 2 ? 2 : 10;
	}
}

static void skin(struct face *f)
{
	struct skin_model *m = &f->model;
	struct rng rng = { 7 };
	for (int i = 0; i < m->n_vertices; i++) {
		double *u = m->u0 + 2 * i;
		m->vertices[i] = i;
		see(u, f->skin.vertices[i]);
		double J[2][4] = { { 1, 0, (u[0] - 640) / 500, 0 }, { 0, 1, 0, (u[1] - 360) / 250 } };
		memcpy(m->J + 8 * i, J, sizeof J);
	}
	for (int k = 0; k < m->n_skin_pc; k++)
		for (int i = 0; i < m->n_lid + m->n_au; i++)
			m->M[k * (m->n_lid + m->n_au + 1) + i] = (i < m->n_lid ? 0.01 : 3) * rng_range(&rng, -1, 1);
}

void face_make(struct face *f, bool flat)
{
	*f = (struct face){ .radius = 12, .center = { { pupil_distance / 2, 0, 0 }, { -pupil_distance / 2, 0, 0 } } };
	f->center[0][2] = f->center[1][2] = flat ? -100 : 0;
	sheet(&f->skin, flat);
	character(f);
	struct skin_model *m = &f->model;
	*m = (struct skin_model){ .n_au = 2, .n_points = POINTS, .n_vertices = ACROSS * UP, .n_lid_pc = SKIN_LIDS, .n_skin_pc = 4 };
	skin_model_alloc(m);
	m->au_names[0] = mem_str("brow");
	m->au_names[1] = mem_str("squint");
	m->camera = (struct skin_camera){ 1280, 720, focal, { 640, 360 }, { 0 }, { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, distance }, { 0, 0, 0, 1 } } };
	lids(m);
	skin(f);
	for (int i = 0; i < m->n_inputs; i++) {
		m->low[i] = i % 5 < 3 && i < SKIN_EYE_INPUTS ? -20 : 0;
		m->high[i] = i % 5 < 3 && i < SKIN_EYE_INPUTS ? 20 : 1;
	}
	for (int k = 0; k < 4; k++) {
		m->rest_controls[k < 2 ? 3 + k : 6 + k] = 0.8;
		m->baseline[k / 2][k % 2][1] = 0.01;
		m->baseline[k / 2][k % 2][2] = 0.8;
	}
}

void face_free(struct face *f)
{
	mesh_free(&f->skin);
	mesh_free(&f->character);
	skin_model_free(&f->model);
	free(f->b_start);
	free(f->b_column);
	free(f->b_weight);
}

struct rig_conf face_conf(void)
{
	return (struct rig_conf){ .neighbours = 8, .fade = { 2, 22 }, .glue = { 2.5, 6 }, .thickness = 1.6, .least = 0.05, .lid = 0, .lid_gap = 5,
		                      .within = { 2.5, 1 }, .beyond = { 3.5, 2.5 }, .tarsus = { 4, 12 }, .seal = -1, .min_confidence = 0.2, .map_step = 2,
		                      .globe_cells = 192, .cornea_bulge = 1.03 };
}

struct rig_character face_character(const struct face *f)
{
	struct rig_character c = { .mesh = &f->character, .registered = (const float(*)[3])f->character.vertices, .b_start = f->b_start,
		                       .b_column = f->b_column, .b_weight = f->b_weight, .eye_radius = f->radius };
	for (int i = 0; i < 4; i++)
		c.subject_from_target[i][i] = 1;
	memcpy(c.eye_center, f->center, sizeof c.eye_center);
	return c;
}

bool face_rig(struct rig *rig, struct rig_report *report, const struct face *face, const struct rig_conf *conf, struct err *err)
{
	struct rig_motion motion;
	struct rig_report own;
	struct rig_character c = face_character(face);
	rig_motion_of_model(&motion, &face->model);
	bool ok = rig_make(rig, report ? report : &own, &motion, &c, conf, err);
	rig_motion_free(&motion);
	return ok;
}
