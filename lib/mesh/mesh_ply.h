/* mesh_ply: the header of a PLY file, for mesh_clean_ply.c and mesh_peek.c. */
#ifndef MESH_MESH_PLY_H
#define MESH_MESH_PLY_H
#include "base/err.h"

enum { PLY_PROPERTIES_MAX = 64, PLY_ELEMENTS_MAX = 2 };
enum ply_format { PLY_ASCII, PLY_LITTLE, PLY_BIG };

/* Meaning of a property. */
enum ply_role { PLY_X, PLY_Y, PLY_Z, PLY_RED, PLY_GREEN, PLY_BLUE, PLY_CORNERS, PLY_UNUSED };

struct ply_property {
	int size, count_size;  // bytes of a value; of a list's length, 0 where it is no list
	bool is_float, is_signed;
	enum ply_role role;
};

struct ply_element {
	char name[32];
	long count;
	struct ply_property props[PLY_PROPERTIES_MAX];
	int n_props;
	unsigned roles;  // a bit for each role that a property has
};

struct ply {
	const char *at, *end;
	int format;  // -1: none yet
	int n_elements;
	struct ply_element element[PLY_ELEMENTS_MAX];  // vertex, then face
};

/* Parses the header, from ply->at; ply->at is then behind its last line. Returns false, err set, where it is malformed. */
bool ply_head(struct ply *ply, struct err *err);

#endif
