#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh_check.h"

enum { PROPERTIES_MAX = 64, CORNERS_MAX = 255, HEAD_LINE_MAX = 1000 };

struct property {
	int size, count_size;  // bytes of a value; of a list's length, 0 where it is no list
	bool is_indices;
};

struct element {
	char name[32];
	long count;
	struct property props[PROPERTIES_MAX];
	int n_props, axes;  // axes: how many of x, y, z
};

enum { ASCII, LITTLE, BIG };

struct ply {
	const char *at, *end;
	int format;  // -1 none yet, or one of:
	long limit, n_vertices;
};

static int type_size(const char *type, bool *is_float)
{
	static const struct {
		const char *name;
		int size;
		bool is_float;
	} types[] = { { "char", 1, 0 },   { "int8", 1, 0 },   { "uchar", 1, 0 }, { "uint8", 1, 0 },  { "short", 2, 0 },
		      { "int16", 2, 0 },  { "ushort", 2, 0 }, { "uint16", 2, 0 }, { "int", 4, 0 },    { "int32", 4, 0 },
		      { "uint", 4, 0 },   { "uint32", 4, 0 }, { "float", 4, 1 }, { "float32", 4, 1 }, { "double", 8, 1 },
		      { "float64", 8, 1 } };
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (!strcmp(types[i].name, type)) {
			*is_float = types[i].is_float;
			return types[i].size;
		}
	return 0;
}

/* An unsigned number of `size` bytes; -1 past the end. */
static int64_t binary(struct ply *ply, int size)
{
	uint64_t v = 0;
	if (ply->end - ply->at < size)
		return -1;
	for (int i = 0; i < size; i++)
		v |= (uint64_t)(unsigned char)ply->at[ply->format == BIG ? size - 1 - i : i] << 8 * i;
	ply->at += size;
	return size == 8 ? -1 : (int64_t)v;
}

/* The next word of a text body; null at the end. */
static const char *word(struct ply *ply)
{
	while (ply->at < ply->end && isspace((unsigned char)*ply->at))
		ply->at++;
	const char *from = ply->at;
	while (ply->at < ply->end && !isspace((unsigned char)*ply->at))
		ply->at++;
	return ply->at > from ? from : 0;
}

/* The next word as a whole number; -1 where it is none or below zero. */
static int64_t text(struct ply *ply)
{
	const char *from = word(ply);
	return from && isdigit((unsigned char)*from) ? strtoll(from, 0, 10) : -1;
}

/* A word of a text body that is a number a float can hold. */
static bool is_number(const char *from)
{
	char *after;
	float x = strtof(from, &after);
	return after > from && isfinite(x) && (!*after || isspace((unsigned char)*after));
}

static bool skip(struct ply *ply, long bytes_or_words)
{
	if (ply->format != ASCII) {
		if (ply->end - ply->at < bytes_or_words)
			return false;
		ply->at += bytes_or_words;
		return true;
	}
	for (long i = 0; i < bytes_or_words; i++) {
		const char *from = word(ply);
		if (!from || !is_number(from))
			return false;
	}
	return true;
}

static bool check_list(struct ply *ply, const struct property *p, long row, struct err *err)
{
	int64_t n = ply->format == ASCII ? text(ply) : binary(ply, p->count_size);
	if (n < 0)
		return err_set(err, "ends in its face %ld", row);
	if (!p->is_indices)
		return skip(ply, ply->format == ASCII ? n : n * p->size) || err_set(err, "ends in its face %ld", row);
	if (n < 3 || n > CORNERS_MAX)
		return err_set(err, "face %ld has %lld corners: must be 3 to %d", row, (long long)n, CORNERS_MAX);
	for (int64_t i = 0; i < n; i++) {
		int64_t v = ply->format == ASCII ? text(ply) : binary(ply, p->size);
		if (v < 0 || v >= ply->n_vertices)
			return err_set(err, "face %ld: corner %lld is no vertex: must be in [0, %ld]", row, (long long)v,
			               ply->n_vertices - 1);
	}
	return true;
}

static bool check_rows(struct ply *ply, const struct element *e, struct err *err)
{
	bool vertices = !strcmp(e->name, "vertex");
	if (e->count > ply->limit)
		return err_set(err, "%ld %s rows: must be <= %ld", e->count, e->name, ply->limit);
	for (long row = 0; row < e->count; row++)
		for (int p = 0; p < e->n_props; p++) {
			const struct property *prop = &e->props[p];
			if (prop->count_size && !vertices) {
				if (!check_list(ply, prop, row, err))
					return false;
			} else if (!skip(ply, ply->format == ASCII ? 1 : prop->size))
				return err_set(err, "ends in row %ld of %ld of its element %s, or has no number there", row, e->count, e->name);
		}
	return true;
}

/* One line of the head into e; a finished element is left for the caller when the next begins. */
static bool take_property(struct element *e, char *line, struct err *err)
{
	char *word[6] = { 0 }, *save = 0;
	int n = 0;
	for (char *w = strtok_r(line, " \t\r", &save); w && n < 6; w = strtok_r(0, " \t\r", &save))
		word[n++] = w;
	bool list = n == 5 && !strcmp(word[1], "list"), is_float = false, ignored;
	if ((!list && n != 3) || e->n_props == PROPERTIES_MAX)
		return err_set(err, "PLY head: a property that is none");
	struct property *p = &e->props[e->n_props++];
	*p = (struct property){ .size = type_size(word[list ? 3 : 1], &is_float) };
	if (list)
		p->count_size = type_size(word[2], &ignored);
	p->is_indices = list && !strcmp(e->name, "face") && (!strcmp(word[4], "vertex_indices") || !strcmp(word[4], "vertex_index"));
	if (!p->size || (list && (!p->count_size || p->count_size > 4)) || (p->is_indices && (is_float || p->size > 4)))
		return err_set(err, "PLY head: type of property %.30s", word[list ? 4 : 2]);
	const char *name = word[list ? 4 : 2];
	e->axes += !list && strlen(name) == 1 && *name >= 'x' && *name <= 'z';
	if (list && !strcmp(e->name, "vertex"))
		return err_set(err, "PLY head: lists in vertices are not read");
	return true;
}

static bool next_line(struct ply *ply, char line[HEAD_LINE_MAX + 1])
{
	const char *nl = memchr(ply->at, '\n', (size_t)(ply->end - ply->at));
	if (!nl || nl - ply->at > HEAD_LINE_MAX || memchr(ply->at, 0, (size_t)(nl - ply->at)))
		return false;
	memcpy(line, ply->at, (size_t)(nl - ply->at));
	line[nl - ply->at] = 0;
	line[strcspn(line, "\r")] = 0;
	ply->at = nl + 1;
	return true;
}

static bool take_format(struct ply *ply, const char *line, struct err *err)
{
	static const char *const formats[] = { "format ascii 1.0", "format binary_little_endian 1.0",
		                               "format binary_big_endian 1.0" };
	for (int i = ASCII; i <= BIG; i++)
		if (!strcmp(formats[i], line)) {
			ply->format = i;
			return true;
		}
	return err_set(err, "PLY head: %.40s", line);
}

enum { ELEMENTS_MAX = 2 };

static bool is_remark(const char *line)
{
	return !strcmp(line, "ply") || !strcmp(line, "end_header") || !strcmp(line, "comment") || !strcmp(line, "obj_info")
	       || !strncmp(line, "comment ", 8) || !strncmp(line, "obj_info ", 9);
}

/* One line of the head; e[*n - 1] is the element it speaks of. */
static bool take_line(struct ply *ply, char *line, struct element e[ELEMENTS_MAX], int *n, struct err *err)
{
	if (!strncmp(line, "format ", 7))
		return take_format(ply, line, err);
	if (!strncmp(line, "property ", 9))
		return *n ? take_property(&e[*n - 1], line, err) : err_set(err, "PLY head: a property of no element");
	if (strncmp(line, "element ", 8))
		return is_remark(line) || err_set(err, "PLY head: %.40s", line);
	// Faces speak of vertices: these come first. OpenMesh loses its way in elements of other names.
	static const char *const names[ELEMENTS_MAX] = { "vertex", "face" };
	int end = 0;
	if (*n == ELEMENTS_MAX || sscanf(line, "element %31s %ld%n", e[*n].name, &e[*n].count, &end) != 2 || line[end]
	    || e[*n].count < 0 || strcmp(e[*n].name, names[*n]))
		return err_set(err, "PLY head: %.40s: must be elements vertex, then face", line);
	ply->n_vertices = e[0].count;
	++*n;
	return true;
}

bool mesh_check_ply(const char *data, size_t size, long limit, struct err *err)
{
	struct ply ply = { .at = data, .end = data + size, .limit = limit, .format = -1 };
	struct element *e = mem_new(ELEMENTS_MAX, sizeof *e);
	char line[HEAD_LINE_MAX + 1];
	int n = 0;
	bool ok = true, ended = false;
	while (ok && !ended && next_line(&ply, line)) {
		ok = take_line(&ply, line, e, &n, err);
		ended = !strcmp(line, "end_header");
	}
	if (ok && !ended)
		ok = err_set(err, "is truncated: the PLY head does not end");
	if (ok && (!n || e->axes != 3 || ply.format < 0))
		ok = err_set(err, "PLY head: no format, or no vertices with x, y and z");
	for (int i = 0; ok && i < n; i++)
		ok = check_rows(&ply, &e[i], err);
	free(e);
	return ok;
}
