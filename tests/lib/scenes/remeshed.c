#include "tests/lib/scenes/remeshed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/vec.h"
#include "mesh/topology.h"

/* The faces of one piece, -1: of all. */
static struct mesh piece_of(const struct mesh *m, const int32_t *piece, int which)
{
	struct mesh out = { .vertices = mem_new((size_t)m->n_vertices + 1, sizeof *out.vertices), .faces = mem_new((size_t)m->n_faces + 1, sizeof *out.faces) };
	int *row = mem_new((size_t)m->n_vertices + 1, sizeof *row);
	for (int f = 0; f < m->n_faces; f++) {
		if (which >= 0 && piece[m->faces[f][0]] != which)
			continue;
		for (int k = 0; k < 3; k++) {
			const int v = m->faces[f][k];
			if (!row[v]) {
				memcpy(out.vertices[out.n_vertices++], m->vertices[v], sizeof *out.vertices);
				row[v] = out.n_vertices;
			}
			out.faces[out.n_faces][k] = row[v] - 1;
		}
		out.n_faces++;
	}
	free(row);
	return out;
}

/* The middle of an edge, drawn onto the planes of its ends' normals (Phong tessellation, Boubekeur and Alexa 2008). */
static void middle(float out[3], const struct mesh *m, const float (*normal)[3], int a, int b)
{
	static const float share = 0.75f;
	float mid[3];
	for (int c = 0; c < 3; c++)
		out[c] = mid[c] = 0.5f * (m->vertices[a][c] + m->vertices[b][c]);
	for (int end = 0; end < 2; end++) {
		const int v = end ? b : a;
		float off = 0;
		for (int c = 0; c < 3; c++)
			off += (mid[c] - m->vertices[v][c]) * normal[v][c];
		for (int c = 0; c < 3; c++)
			out[c] -= 0.5f * share * off * normal[v][c];
	}
}

/* Each face in four. */
static void divide(struct mesh *m)
{
	float (*normal)[3] = mesh_normals(m);
	struct topology t;
	topology_make(&t, m);
	struct mesh out = { .n_vertices = m->n_vertices, .n_faces = 4 * m->n_faces };
	int *made = mem_new((size_t)t.start[t.n] + 1, sizeof *made);
	out.vertices = mem_new((size_t)(m->n_vertices + t.start[t.n]) + 1, sizeof *out.vertices);
	out.faces = mem_new((size_t)out.n_faces + 1, sizeof *out.faces);
	memcpy(out.vertices, m->vertices, (size_t)m->n_vertices * sizeof *out.vertices);
	for (int f = 0; f < m->n_faces; f++) {
		int32_t v[6];
		for (int k = 0; k < 3; k++) {
			v[k] = m->faces[f][k];
			const int a = v[k] < m->faces[f][(k + 1) % 3] ? v[k] : m->faces[f][(k + 1) % 3], b = v[k] + m->faces[f][(k + 1) % 3] - a;
			int at = t.start[a];
			while (t.neighbour[at] != b)
				at++;
			if (!made[at]) {
				middle(out.vertices[out.n_vertices], m, (const float(*)[3])normal, a, b);
				made[at] = ++out.n_vertices;
			}
			v[3 + k] = made[at] - 1;
		}
		static const int of[4][3] = { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 }, { 3, 4, 5 } };
		for (int k = 0; k < 12; k++)
			out.faces[4 * f + k / 3][k % 3] = v[of[k / 3][k % 3]];
	}
	free(made);
	topology_free(&t);
	free((void *)normal);
	mesh_free(m);
	*m = out;
}

/* A sphere of 1280 triangles. */
static struct mesh sphere(const double ball[4])
{
	static const float g = 1.618034f, corner[12][3] = { { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 }, { 1, -g, 0 }, { 0, -1, g }, { 0, 1, g },
		                                                { 0, -1, -g }, { 0, 1, -g }, { g, 0, -1 }, { g, 0, 1 }, { -g, 0, -1 }, { -g, 0, 1 } };
	static const int32_t face[20][3] = { { 0, 11, 5 }, { 0, 5, 1 }, { 0, 1, 7 }, { 0, 7, 10 }, { 0, 10, 11 }, { 1, 5, 9 }, { 5, 11, 4 }, { 11, 10, 2 }, { 10, 7, 6 }, { 7, 1, 8 },
		                                 { 3, 9, 4 }, { 3, 4, 2 }, { 3, 2, 6 }, { 3, 6, 8 }, { 3, 8, 9 }, { 4, 9, 5 }, { 2, 4, 11 }, { 6, 2, 10 }, { 8, 6, 7 }, { 9, 8, 1 } };
	struct mesh m = { .n_vertices = 12, .n_faces = 20, .vertices = mem_new(12, sizeof *m.vertices), .faces = mem_new(20, sizeof *m.faces) };
	memcpy(m.vertices, corner, sizeof corner);
	memcpy(m.faces, face, sizeof face);
	for (int k = 0; k < 3; k++)
		divide(&m);
	for (int i = 0; i < m.n_vertices; i++) {
		vecf_unit(m.vertices[i]);
		for (int c = 0; c < 3; c++)
			m.vertices[i][c] = (float)(ball[c] + ball[3] * m.vertices[i][c]);
	}
	return m;
}

static void append(struct mesh *to, const struct mesh *m)
{
	to->vertices = mem_grow(to->vertices, (size_t)(to->n_vertices + m->n_vertices) + 1, sizeof *to->vertices);
	to->faces = mem_grow(to->faces, (size_t)(to->n_faces + m->n_faces) + 1, sizeof *to->faces);
	memcpy(to->vertices + to->n_vertices, m->vertices, (size_t)m->n_vertices * sizeof *to->vertices);
	for (int f = 0; f < m->n_faces; f++)
		for (int k = 0; k < 3; k++)
			to->faces[to->n_faces + f][k] = m->faces[f][k] + to->n_vertices;
	to->n_vertices += m->n_vertices;
	to->n_faces += m->n_faces;
}

/* The second and third largest pieces, by their boxes: left, right. */
static bool find_balls(double ball[2][4], const struct mesh *m, const struct topology *t)
{
	for (int k = 1; k < 3; k++) {
		float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
		for (int i = 0; i < m->n_vertices; i++)
			for (int c = 0; c < 3 && t->piece[i] == k; c++) {
				lo[c] = fminf(lo[c], m->vertices[i][c]);
				hi[c] = fmaxf(hi[c], m->vertices[i][c]);
			}
		double *to = ball[lo[0] + hi[0] < 0];
		for (int c = 0; c < 3; c++)
			to[c] = 0.5 * (double)(lo[c] + hi[c]);
		to[3] = 0.25 * (double)(hi[0] - lo[0] + hi[1] - lo[1]);
	}
	return ball[0][3] > 0 && ball[1][3] > 0;
}

bool remeshed_make(struct mesh *out, const struct mesh *in, const struct remeshed *how, struct err *err)
{
	struct topology t;
	const double *b = how->ball;
	double ball[2][4] = { { b[0], b[1], b[2], b[3] }, { -b[0], b[1], b[2], b[3] } };
	topology_make(&t, in);
	bool ok = b[3] > 0 || (t.n_pieces >= 3 && find_balls(ball, in, &t)) || err_set(err, "no two eyeballs");
	*out = piece_of(in, t.piece, b[3] > 0 ? -1 : 0);
	if (ok && how->faces) {
		divide(out);
		while (out->n_faces < how->faces)
			divide(out);
		ok = om_mesh_decimate(out, how->faces, err);
	}
	for (int c = 0; c < 3 && ok; c++) {
		const double mid = 0.5 * (ball[0][c] + ball[1][c]), by = how->stretch[c] > 0 ? how->stretch[c] : 1;
		for (int i = 0; i < out->n_vertices; i++)
			out->vertices[i][c] = (float)(mid + by * ((double)out->vertices[i][c] - mid));
		for (int s = 0; s < 2; s++) {
			ball[s][c] = mid + by * (ball[s][c] - mid);
			ball[s][3] *= c == 1 ? by : 1;
		}
	}
	for (int s = 0; s < 2 && ok; s++) {
		struct mesh eye = sphere(ball[s]);
		append(out, &eye);
		mesh_free(&eye);
	}
	topology_free(&t);
	return ok;
}
