#include "mesh/mesh_clean_ply.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh_joins.h"
#include "mesh/mesh_ply.h"

enum { CORNERS_MAX = 255 };

/* A value of the body in bytes. False past the end. */
static bool binary(double *v, struct ply *ply, int size, bool is_float, bool is_signed)
{
	uint64_t bits = 0;
	uint32_t low;
	float f;
	if (ply->end - ply->at < size)
		return false;
	if (size == 4 && ply->format == PLY_LITTLE) {  // next to all there are
		memcpy(&low, ply->at, sizeof low);
		bits = low;
	} else
		for (int i = 0; i < size; i++)
			bits |= (uint64_t)(unsigned char)ply->at[ply->format == PLY_BIG ? size - 1 - i : i] << 8 * i;
	ply->at += size;
	if (is_float && size == 8)
		memcpy(v, &bits, sizeof *v);
	else if (is_float) {
		low = (uint32_t)bits;
		memcpy(&f, &low, sizeof f);
		*v = (double)f;
	} else {
		int64_t top = 1ll << (8 * size - 1);
		*v = is_signed ? (double)(((int64_t)bits ^ top) - top) : (double)bits;
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

static bool take_vertex(struct mesh *to, struct ply *ply, long row, struct err *err)
{
	const struct ply_element *e = &ply->element[0];
	float *at = to->vertices[row], *colour = to->colours ? to->colours[row] : 0;
	for (int k = 0; k < e->n_props; k++) {
		const struct ply_property *p = &e->props[k];
		double v;
		if (!value(&v, ply, p))
			return err_set(err, "ends in row %ld of %ld of its vertices, or has no number there", row, e->count);
		if (p->role <= PLY_Z)
			at[p->role - PLY_X] = (float)v;
		else if (p->role <= PLY_BLUE && colour) {
			v = p->is_float ? v : v / 255;
			colour[p->role - PLY_RED] = (float)(v > 0 ? v < 1 ? v : 1 : 0);  // NaN: 0
		}
	}
	return true;
}

/* A face as a fan of triangles; those with a corner twice have no area and are left out. */
static void fan(struct mesh *to, int *room, const int32_t *corner, int n)
{
	if (to->n_faces + n > *room)
		to->faces = mem_grow(to->faces, (size_t)(*room = 2 * (to->n_faces + n)), sizeof *to->faces);
	for (int k = 1; k + 1 < n; k++) {
		const int32_t t[3] = { corner[0], corner[k], corner[k + 1] };
		if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
			memcpy(to->faces[to->n_faces++], t, sizeof t);
	}
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

static bool take_face(struct mesh *to, int *room, struct ply *ply, long row, struct err *err)
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
	fan(to, room, corner, n);
	return true;
}

static bool body(struct mesh *mesh, struct ply *ply, long limit, struct err *err)
{
	for (int i = 0; i < ply->n_elements; i++)
		if (ply->element[i].count > limit)
			return err_set(err, "%ld %s rows: must be <= %ld", ply->element[i].count, ply->element[i].name, limit);
	long n = ply->element[0].count, m = ply->element[1].count;
	int room = 0;
	if (n > ply->end - ply->at)
		return err_set(err, "its %ld bytes end before the last of %ld vertices", (long)(ply->end - ply->at), n);
	mesh->vertices = mem_new((size_t)n + 1, sizeof *mesh->vertices);
	mesh->colours = coloured(ply) ? mem_new((size_t)n + 1, sizeof *mesh->colours) : 0;
	mesh->n_vertices = (int)n;
	for (long row = 0; row < n; row++)
		if (!take_vertex(mesh, ply, row, err))
			return false;
	for (long row = 0; row < m; row++) {
		if (!take_face(mesh, &room, ply, row, err))
			return false;
		if (mesh->n_faces > limit)
			return err_set(err, "%d triangles in its first %ld faces: must be <= %ld", mesh->n_faces, row + 1, limit);
	}
	return true;
}

bool mesh_clean_ply(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err)
{
	struct ply *ply = mem_new(1, sizeof *ply);
	*ply = (struct ply){ .at = data, .end = data + size, .format = -1 };
	*mesh = (struct mesh){ 0 };
	bool ok = ply_head(ply, err) && body(mesh, ply, limit, err) && mesh_joins_check(mesh, err);
	free(ply);
	return ok;
}
