#include "tests/lib/variants/turned.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/mesh_part.h"
#include "mesh/outward.h"
#include "register/transfer_lay.h"
#include "register/transfer_unit.h"
#include "tests/lib/conf/transfer_conf.h"

static void random_rotation(double out[3][3], struct rng *rng)
{
	double q[4], n = 0;
	for (int k = 0; k < 4; k++) {
		q[k] = rng_normal(rng);
		n += q[k] * q[k];
	}
	for (int k = 0; k < 4; k++)
		q[k] /= sqrt(n);
	double w = q[0], x = q[1], y = q[2], z = q[3];
	memcpy(out,
	       (double[3][3]){ { 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
	                       { 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
	                       { 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) } },
	       9 * sizeof(double));
}

/* One of six faces up, then one of four quarter turns about it. */
void turned_rotation(double out[3][3], int number, struct rng *rng)
{
	static const double tips[6][3][3] = {
		{ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },   { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } },  { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } },
		{ { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 } },  { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },  { { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } },
	};
	static const double quarter[3][3] = { { 0, 0, 1 }, { 0, 1, 0 }, { -1, 0, 0 } };
	if (number >= 24) {
		random_rotation(out, rng);
		return;
	}
	memcpy(out, tips[number / 4], 9 * sizeof(double));
	for (int i = 0; i < number % 4; i++)
		mat_mul(out, quarter, (const double(*)[3])out);
}

struct mesh turned_mesh(const struct mesh *mesh, const double rotation[3][3], double scale, const double shift[3], bool inward)
{
	struct mesh out = { .n_vertices = mesh->n_vertices, .n_faces = mesh->n_faces };
	out.vertices = mem_array((size_t)mesh->n_vertices + 1, sizeof *out.vertices);
	out.faces = mem_array((size_t)mesh->n_faces + 1, sizeof *out.faces);
	for (int i = 0; i < mesh->n_vertices; i++) {
		double x[3];
		for (int k = 0; k < 3; k++)
			x[k] = (double)mesh->vertices[i][k];
		mat_vec(x, rotation, x);
		for (int k = 0; k < 3; k++)
			out.vertices[i][k] = (float)(scale * x[k] + shift[k]);
	}
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3; k++)
			out.faces[f][k] = mesh->faces[f][inward ? 2 - k : k];
	return out;
}

bool turned_lay(struct transfer *out, char reason[1024], struct mesh *mesh, const struct mesh *subject, const double (*eye)[3])
{
	const struct nricp_landmarks none = { 0 };
	struct mesh_part part;
	struct transfer_check check;
	struct err err = { 0 };
	mesh_turn_outward(mesh);
	double unit = transfer_target_unit(mesh, subject, eye, &transfer_defaults);
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++)
			mesh->vertices[i][k] *= (float)unit;
	mesh_part_make(&part, mesh, transfer_defaults.least_piece, 0);
	bool ok = transfer_lay(out, mesh, &part, subject, eye, &none, &transfer_defaults, &err);
	snprintf(reason, 1024, "%s", err.msg);
	if (ok) {
		ok = transfer_check(&check, out, mesh, subject, eye, &none, &transfer_defaults, &transfer_check_defaults);
		memcpy(reason, check.reason, 1024);
	}
	mesh_part_free(&part);
	return ok;
}
