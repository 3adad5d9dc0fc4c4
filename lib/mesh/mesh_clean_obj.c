#include "mesh/mesh_clean_obj.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh_joins.h"

static const char blanks[] = " \t\r\v\f";

struct obj {
	struct mesh *mesh;
	long line, all_vertices;  // of the file, which a face may name ahead of time
	long limit;
	int room, coloured;       // for faces; vertices with a colour
	struct err *err;
};

/* "v x y z", with r g b behind it or not. */
static bool take_vertex(struct obj *obj, const char *at, const char *end)
{
	float v[6] = { 0 };
	int n = 0;
	for (at += strspn(at, blanks); at < end && n < 6; at += strspn(at, blanks), n++) {
		char *after;
		v[n] = strtof(at, &after);
		if (after == at || after > end || !isfinite(v[n]))
			return err_set(obj->err, "line %ld: a coordinate that is no number", obj->line);
		at = after;
	}
	if (n < 3)
		return err_set(obj->err, "line %ld: a vertex of %d coordinates: must be 3", obj->line, n);
	struct mesh *m = obj->mesh;
	memcpy(m->vertices[m->n_vertices], v, sizeof *m->vertices);
	for (int k = 0; k < 3 && n == 6; k++)
		m->colours[m->n_vertices][k] = v[3 + k] > 0 ? v[3 + k] < 1 ? v[3 + k] : 1 : 0;
	obj->coloured += n == 6;
	m->n_vertices++;
	return true;
}

static bool take_triangle(struct obj *obj, long a, long b, long c)
{
	struct mesh *m = obj->mesh;
	if (m->n_faces == obj->limit)
		return err_set(obj->err, "line %ld: triangle %ld: must be <= %ld", obj->line, obj->limit + 1, obj->limit);
	if (m->n_faces == obj->room)
		m->faces = mem_grow(m->faces, (size_t)(obj->room = 2 * obj->room + 64), sizeof *m->faces);
	int32_t *to = m->faces[m->n_faces++];
	to[0] = (int32_t)(a - 1);
	to[1] = (int32_t)(b - 1);
	to[2] = (int32_t)(c - 1);
	return true;
}

/* Corners "v", "v/t", "v//n", "v/t/n"; from 1, or below zero backwards from the last vertex so far. A fan of triangles
 * comes out; those with a corner twice have no area and are left out. */
static bool take_face(struct obj *obj, const char *at, const char *end)
{
	long first = 0, last = 0;
	int corners = 0;
	for (at += strspn(at, blanks); at < end; at += strspn(at, blanks)) {
		char *after;
		long v = strtol(at, &after, 10);
		bool is_word = after > at && after <= end;
		v = v < 0 ? v + 1 + obj->mesh->n_vertices : v;
		if (!is_word || v < 1 || v > obj->all_vertices)
			return err_set(obj->err, "line %ld: a corner that is no vertex: must be in [1, %ld]", obj->line,
			               obj->all_vertices);
		if (corners >= 2 && first != last && last != v && v != first && !take_triangle(obj, first, last, v))
			return false;
		first = corners++ ? first : v;
		last = v;
		at = after + strcspn(after, " \t\r\v\f\n");
	}
	return corners >= 3 || err_set(obj->err, "line %ld: a face of %d corners: must be at least 3", obj->line, corners);
}

/* Where a text line ends. */
static const char *line_end(const char *at, const char *end)
{
	const char *nl = memchr(at, '\n', (size_t)(end - at));
	return nl ? nl : end;
}

/* What stands behind the line's first word, when it is `letter`; null otherwise. */
static const char *behind(const char *at, const char *end, char letter)
{
	at += strspn(at, blanks);
	return at + 1 < end && *at == letter && strchr(blanks, at[1]) ? at + 1 : 0;
}

/* Lines of that kind. */
static long count(const char *data, size_t size, char letter)
{
	long n = 0;
	for (const char *at = data, *end = data + size; at < end; at = line_end(at, end) + 1)
		n += behind(at, line_end(at, end), letter) != 0;
	return n;
}

long mesh_clean_obj_vertices(const char *data, size_t size)
{
	return count(data, size, 'v');
}

bool mesh_clean_obj(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err)
{
	const char *end = data + size;
	struct obj obj = { .mesh = mesh, .line = 1, .limit = limit, .err = err };
	long faces = count(data, size, 'f');
	*mesh = (struct mesh){ 0 };
	obj.all_vertices = count(data, size, 'v');
	if (!obj.all_vertices)
		return err_set(err, "is no mesh: must be PLY or OBJ");
	if (obj.all_vertices > limit || faces > limit)
		return err_set(err, "%ld vertices, %ld faces: must be <= %ld", obj.all_vertices, faces, limit);
	mesh->vertices = mem_array((size_t)obj.all_vertices, sizeof *mesh->vertices);
	mesh->colours = mem_array((size_t)obj.all_vertices, sizeof *mesh->colours);
	for (const char *at = data; at < end; at = line_end(at, end) + 1, obj.line++) {
		const char *stop = line_end(at, end), *vertex = behind(at, stop, 'v'), *face = behind(at, stop, 'f');
		if ((vertex && !take_vertex(&obj, vertex, stop)) || (face && !take_face(&obj, face, stop)))
			return false;
	}
	if (obj.coloured < mesh->n_vertices) {
		free(mesh->colours);
		mesh->colours = 0;
	}
	return mesh_joins_check(mesh, err);
}
