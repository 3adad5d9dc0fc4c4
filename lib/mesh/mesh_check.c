#include "mesh/mesh_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where a text line ends. */
static const char *line_end(const char *at, const char *end)
{
	const char *nl = memchr(at, '\n', (size_t)(end - at));
	return nl ? nl : end;
}

static bool starts(const char *at, const char *end, const char *with)
{
	size_t n = strlen(with);
	return (size_t)(end - at) > n && !strncmp(at, with, n);
}

static bool check_vertex(const char *at, const char *end, long line, struct err *err)
{
	for (int k = 0; k < 3; k++) {
		char *after;
		float x = strtof(at, &after);
		if (after == at || after > end || !isfinite(x))
			return err_set(err, "line %ld: a coordinate that is no number", line);
		at = after;
	}
	return true;
}

/* Corners "v", "v/t", "v//n", "v/t/n"; from 1, or from the last backwards below zero. */
static bool check_face(const char *at, const char *end, long line, long n_vertices, struct err *err)
{
	int corners = 0;
	for (at += strspn(at, " \t"); at < end && *at != '\r'; at += strspn(at, " \t")) {
		char *after;
		long v = strtol(at, &after, 10);
		if (after == at || after > end || !v || v > n_vertices || v < -n_vertices)
			return err_set(err, "line %ld: a corner that is no vertex: must be in [1, %ld]", line, n_vertices);
		corners++;
		at = after + strcspn(after, " \t\r\n");
	}
	return corners >= 3 || err_set(err, "line %ld: a face of %d corners: must be at least 3", line, corners);
}

static bool check_obj(const char *data, size_t size, long limit, struct err *err)
{
	const char *end = data + size;
	long n_vertices = 0, n_faces = 0, line = 1;
	for (const char *at = data; at < end; at = line_end(at, end) + 1) {
		n_vertices += starts(at, end, "v ");
		n_faces += starts(at, end, "f ");
	}
	if (n_vertices > limit || n_faces > limit)
		return err_set(err, "%ld vertices, %ld faces: must be <= %ld", n_vertices, n_faces, limit);
	if (!n_vertices)
		return err_set(err, "is no mesh: must be PLY or OBJ");
	for (const char *at = data; at < end; at = line_end(at, end) + 1, line++) {
		if (starts(at, end, "v ") && !check_vertex(at + 2, line_end(at, end), line, err))
			return false;
		if (starts(at, end, "f ") && !check_face(at + 2, line_end(at, end), line, n_vertices, err))
			return false;
	}
	return true;
}

bool mesh_check(enum mesh_kind *kind, const char *data, size_t size, long limit, struct err *err)
{
	*kind = MESH_NONE;
	if (!size)
		return err_set(err, "is empty");
	bool ply = !strncmp(data, "ply\n", 4) || !strncmp(data, "ply\r\n", 5);
	if (!ply && memchr(data, 0, size))
		return err_set(err, "is no mesh: must be PLY or OBJ");
	if (ply ? !mesh_check_ply(data, size, limit, err) : !check_obj(data, size, limit, err))
		return false;
	*kind = ply ? MESH_PLY : MESH_OBJ;
	return true;
}
