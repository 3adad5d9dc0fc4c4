#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh_clean.h"
#include "mesh/mesh_joins.h"
#include "mesh/mesh_ply.h"

enum { CORNERS_MAX = 255 };

/* Bytes that grow. */
struct bytes {
	char *data;
	size_t n, room;
};

static void put(struct bytes *to, const void *from, size_t n)
{
	if (to->n + n > to->room) {
		to->room = 2 * (to->n + n);
		to->data = mem_grow(to->data, to->room, 1);
	}
	if (n)
		memcpy(to->data + to->n, from, n);
	to->n += n;
}

/* A value of the body in bytes. False past the end. */
static bool binary(double *v, struct ply *ply, int size, bool is_float, bool is_signed)
{
	uint64_t bits = 0;
	if (ply->end - ply->at < size)
		return false;
	for (int i = 0; i < size; i++)
		bits |= (uint64_t)(unsigned char)ply->at[ply->format == PLY_BIG ? size - 1 - i : i] << 8 * i;
	ply->at += size;
	if (is_float && size == 8)
		memcpy(v, &bits, sizeof *v);
	else if (is_float) {
		float f;
		uint32_t low = (uint32_t)bits;
		memcpy(&f, &low, sizeof f);
		*v = (double)f;
	} else {
		uint64_t top = 1ull << (8 * size - 1);
		*v = is_signed && bits & top ? (double)bits - 2.0 * (double)top : (double)bits;
	}
	return true;
}

/* The next word of a body in text, as a number that a float can hold. */
static bool text(double *v, struct ply *ply)
{
	while (ply->at < ply->end && isspace((unsigned char)*ply->at))
		ply->at++;
	char *after;
	*v = (double)strtof(ply->at, &after);
	bool good = after > ply->at && after <= ply->end && isfinite(*v) && (after == ply->end || isspace((unsigned char)*after));
	if (good && fabs(*v) >= 1 << 24)
		*v = strtod(ply->at, 0);  // a corner's number beyond what a float counts
	ply->at = after;
	return good;
}

static bool value(double *v, struct ply *ply, const struct ply_property *p)
{
	return ply->format == PLY_ASCII ? text(v, ply) : binary(v, ply, p->size, p->is_float, p->is_signed);
}

static bool coloured(const struct ply *ply)
{
	unsigned rgb = 1u << PLY_RED | 1u << PLY_GREEN | 1u << PLY_BLUE;
	return (ply->element[0].roles & rgb) == rgb;
}

static bool take_vertex(struct bytes *to, struct ply *ply, long row, struct err *err)
{
	const struct ply_element *e = &ply->element[0];
	float at[3] = { 0 };
	unsigned char colour[3] = { 0 };
	for (int k = 0; k < e->n_props; k++) {
		const struct ply_property *p = &e->props[k];
		double v;
		if (!value(&v, ply, p))
			return err_set(err, "ends in row %ld of %ld of its vertices, or has no number there", row, e->count);
		if (p->role <= PLY_Z)
			at[p->role - PLY_X] = (float)v;
		else if (p->role <= PLY_BLUE) {
			v = p->is_float ? v * 255 : v;
			colour[p->role - PLY_RED] = (unsigned char)(v > 0 ? v < 255 ? v + 0.5 : 255 : 0);  // NaN: 0
		}
	}
	put(to, at, sizeof at);
	if (coloured(ply))
		put(to, colour, sizeof colour);
	return true;
}

/* A face as a fan of triangles; those with a corner twice have no area and are left out. */
static int fan(struct bytes *to, const int32_t *corner, int n)
{
	int made = 0;
	for (int k = 1; k + 1 < n; k++) {
		int32_t t[3] = { corner[0], corner[k], corner[k + 1] };
		if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
			continue;
		put(to, &(unsigned char){ 3 }, 1);
		put(to, t, sizeof t);
		made++;
	}
	return made;
}

/* A face's list: its corners where it is theirs (*n of them), otherwise passed over. */
static bool take_list(int32_t corner[CORNERS_MAX], int *n, struct ply *ply, const struct ply_property *p, long row, struct err *err)
{
	double count, v, last = (double)ply->element[0].count - 1;
	bool counted = ply->format == PLY_ASCII ? text(&count, ply) : binary(&count, ply, p->count_size, false, false);
	if (!counted || count != floor(count) || count < 0)
		return err_set(err, "ends in its face %ld", row);
	if (p->role != PLY_CORNERS) {
		for (double i = 0; i < count; i++)
			if (!value(&v, ply, p))
				return err_set(err, "ends in its face %ld", row);
		return true;
	}
	if (count < 3 || count > CORNERS_MAX)
		return err_set(err, "face %ld has %.0f corners: must be 3 to %d", row, count, CORNERS_MAX);
	*n = (int)count;
	for (int i = 0; i < *n; i++) {
		if (!value(&v, ply, p))
			return err_set(err, "ends in its face %ld", row);
		if (!(v >= 0 && v <= last && v == floor(v)))
			return err_set(err, "face %ld: corner %.0f is no vertex: must be in [0, %.0f]", row, v, last);
		corner[i] = (int32_t)v;
	}
	return true;
}

static bool take_face(struct bytes *to, int *made, struct ply *ply, long row, struct err *err)
{
	const struct ply_element *e = &ply->element[1];
	int32_t corner[CORNERS_MAX];
	int n = 0;
	for (int k = 0; k < e->n_props; k++) {
		double v;
		if (e->props[k].count_size && !take_list(corner, &n, ply, &e->props[k], row, err))
			return false;
		if (!e->props[k].count_size && !value(&v, ply, &e->props[k]))
			return err_set(err, "ends in row %ld of %ld of its faces, or has no number there", row, e->count);
	}
	*made += fan(to, corner, n);
	return true;
}

static bool body(struct bytes *vertices, struct bytes *faces, int *made, struct ply *ply, long limit, struct err *err)
{
	for (int i = 0; i < ply->n_elements; i++)
		if (ply->element[i].count > limit)
			return err_set(err, "%ld %s rows: must be <= %ld", ply->element[i].count, ply->element[i].name, limit);
	for (long row = 0; row < ply->element[0].count; row++)
		if (!take_vertex(vertices, ply, row, err))
			return false;
	for (long row = 0; row < ply->element[1].count; row++) {
		if (!take_face(faces, made, ply, row, err))
			return false;
		if (*made > limit)
			return err_set(err, "%d triangles in its first %ld faces: must be <= %ld", *made, row + 1, limit);
	}
	return true;
}

/* Whether the triangles, as they were put, can be joined. */
static bool joins_end(const struct bytes *faces, int made, long n_vertices, struct err *err)
{
	struct mesh_joins joins = mesh_joins_begin(n_vertices);
	for (int i = 0; i < made; i++) {
		int32_t corner[3];
		memcpy(corner, faces->data + (size_t)i * (1 + sizeof corner) + 1, sizeof corner);
		mesh_joins_add(&joins, corner);
	}
	return mesh_joins_end(&joins, err);
}

bool mesh_clean_ply(char **clean, size_t *clean_size, const char *data, size_t size, long limit, struct err *err)
{
	struct ply *ply = mem_new(1, sizeof *ply);
	struct bytes vertices = { 0 }, faces = { 0 }, out = { 0 };
	int made = 0;
	*ply = (struct ply){ .at = data, .end = data + size, .format = -1 };
	bool ok = ply_head(ply, err) && body(&vertices, &faces, &made, ply, limit, err)
	          && joins_end(&faces, made, ply->element[0].count, err);
	if (ok) {
		_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values go out as they lie in memory");
		const char *colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
		char *head = mem_printf("ply\nformat binary_little_endian 1.0\nelement vertex %ld\n"
		                        "property float x\nproperty float y\nproperty float z\n%s"
		                        "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
		                        ply->element[0].count, coloured(ply) ? colours : "", made);
		put(&out, head, strlen(head));
		put(&out, vertices.data, vertices.n);
		put(&out, faces.data, faces.n);
		free(head);
	}
	free(vertices.data);
	free(faces.data);
	free(ply);
	*clean = out.data;
	*clean_size = out.n;
	return ok;
}
