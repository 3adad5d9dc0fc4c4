#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh_ply.h"

enum { HEAD_LINE_MAX = 1000 };

static bool take_type(struct ply_property *p, const char *type)
{
	static const struct {
		const char *name;
		int size;
		bool is_float, is_signed;
	} types[] = { { "char", 1, 0, 1 },   { "int8", 1, 0, 1 },    { "uchar", 1, 0, 0 },  { "uint8", 1, 0, 0 },
		      { "short", 2, 0, 1 },  { "int16", 2, 0, 1 },   { "ushort", 2, 0, 0 }, { "uint16", 2, 0, 0 },
		      { "int", 4, 0, 1 },    { "int32", 4, 0, 1 },   { "uint", 4, 0, 0 },   { "uint32", 4, 0, 0 },
		      { "float", 4, 1, 1 },  { "float32", 4, 1, 1 }, { "double", 8, 1, 1 }, { "float64", 8, 1, 1 } };
	for (int i = 0; i < COUNT(types); i++)
		if (!strcmp(types[i].name, type)) {
			p->size = types[i].size;
			p->is_float = types[i].is_float;
			p->is_signed = types[i].is_signed;
			return true;
		}
	return false;
}

static enum ply_role role_of(const char *element, bool list, const char *name)
{
	static const char *const names[] = { "x", "y", "z", "red", "green", "blue" };
	if (list)
		return !strcmp(element, "face") && (!strcmp(name, "vertex_indices") || !strcmp(name, "vertex_index")) ? PLY_CORNERS
		                                                                                                     : PLY_UNUSED;
	for (int i = 0; i < COUNT(names) && !strcmp(element, "vertex"); i++)
		if (!strcmp(names[i], name))
			return (enum ply_role)(PLY_X + i);
	return PLY_UNUSED;
}

/* Parses one line of the header into e. */
static bool take_property(struct ply_element *e, char *line, struct err *err)
{
	char *word[6] = { 0 }, *save = 0;
	int n = 0;
	for (char *w = strtok_r(line, " \t\r", &save); w && n < 6; w = strtok_r(0, " \t\r", &save))
		word[n++] = w;
	bool list = n == 5 && !strcmp(word[1], "list");
	if ((!list && n != 3) || e->n_props == PLY_PROPERTIES_MAX)
		return err_set(err, "PLY head: a property that is none");
	const char *name = word[list ? 4 : 2];
	struct ply_property *p = &e->props[e->n_props++], length = { 0 };
	*p = (struct ply_property){ .role = role_of(e->name, list, name) };
	bool good = take_type(p, word[list ? 3 : 1]) && (!list || (take_type(&length, word[2]) && !length.is_float));
	if (!good || (p->role == PLY_CORNERS && p->is_float))
		return err_set(err, "PLY head: type of property %.30s", name);
	p->count_size = length.size;
	if (p->role != PLY_UNUSED && e->roles & 1u << p->role)
		return err_set(err, "PLY head: property %.30s twice", name);
	e->roles |= 1u << p->role;
	if (list && !strcmp(e->name, "vertex"))
		return err_set(err, "PLY head: lists in vertices are not read");
	return true;
}

static bool next_line(struct ply *ply, char line[HEAD_LINE_MAX + 1])
{
	const char *nl = memchr(ply->at, '\n', (size_t)(ply->end - ply->at));
	if (!nl || memchr(ply->at, 0, (size_t)(nl - ply->at)))
		return false;
	long n = nl - ply->at;
	// Of a comment (what made the mesh from what may be long) the beginning is enough.
	if (n > HEAD_LINE_MAX && strncmp(ply->at, "comment ", 8))
		return false;
	n = n > HEAD_LINE_MAX ? HEAD_LINE_MAX : n;
	memcpy(line, ply->at, (size_t)n);
	line[n] = 0;
	line[strcspn(line, "\r")] = 0;
	ply->at = nl + 1;
	return true;
}

static bool take_format(struct ply *ply, const char *line, struct err *err)
{
	static const char *const formats[] = { "format ascii 1.0", "format binary_little_endian 1.0",
		                               "format binary_big_endian 1.0" };
	for (int i = PLY_ASCII; i <= PLY_BIG; i++)
		if (!strcmp(formats[i], line)) {
			ply->format = i;
			return true;
		}
	return err_set(err, "PLY head: %.40s", line);
}

static bool is_remark(const char *line)
{
	return !strcmp(line, "ply") || !strcmp(line, "end_header") || !strcmp(line, "comment") || !strcmp(line, "obj_info")
	       || !strncmp(line, "comment ", 8) || !strncmp(line, "obj_info ", 9);
}

static bool take_element(struct ply *ply, const char *line, struct err *err)
{
	// Faces refer to vertices, so vertices must come first.
	static const char *const names[PLY_ELEMENTS_MAX] = { "vertex", "face" };
	struct ply_element *e = &ply->element[ply->n_elements < PLY_ELEMENTS_MAX ? ply->n_elements : 0];
	int end = 0;
	if (ply->n_elements == PLY_ELEMENTS_MAX || sscanf(line, "element %31s %ld%n", e->name, &e->count, &end) != 2 || line[end]
	    || e->count < 0 || strcmp(e->name, names[ply->n_elements]))
		return err_set(err, "PLY head: %.40s: must be elements vertex, then face", line);
	ply->n_elements++;
	return true;
}

static bool take_line(struct ply *ply, char *line, struct err *err)
{
	if (!strncmp(line, "format ", 7))
		return take_format(ply, line, err);
	if (!strncmp(line, "element ", 8))
		return take_element(ply, line, err);
	if (strncmp(line, "property ", 9))
		return is_remark(line) || err_set(err, "PLY head: %.40s", line);
	if (!ply->n_elements)
		return err_set(err, "PLY head: a property of no element");
	return take_property(&ply->element[ply->n_elements - 1], line, err);
}

bool ply_head(struct ply *ply, struct err *err)
{
	char line[HEAD_LINE_MAX + 1];
	bool ended = false;
	while (!ended && next_line(ply, line)) {
		ended = !strcmp(line, "end_header");
		if (!take_line(ply, line, err))
			return false;
	}
	if (!ended)
		return err_set(err, "is truncated: the PLY head does not end");
	unsigned axes = 1u << PLY_X | 1u << PLY_Y | 1u << PLY_Z;
	if (ply->format < 0 || (ply->element[0].roles & axes) != axes)
		return err_set(err, "PLY head: no format, or no vertices with x, y and z");
	return true;
}
