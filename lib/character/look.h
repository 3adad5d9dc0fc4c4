/* look: what a character's file has beside its surface: texture coordinates, materials, textures, blend shapes. It stands beside a
 * struct mesh of the same faces, whose vertices are the points of the surface: where a file has two vertices at one place, because
 * a seam of the texture runs through, they are one point and two wedges.
 */
#ifndef CHARACTER_LOOK_H
#define CHARACTER_LOOK_H
#include <stddef.h>
#include <stdint.h>

#include "mesh/mesh.h"

enum look_map { LOOK_COLOUR, LOOK_NORMAL, LOOK_ROUGH, LOOK_GLOW, LOOK_OCCLUSION, LOOK_MAPS };  // LOOK_ROUGH: green roughness, blue metalness
enum look_alpha { LOOK_OPAQUE, LOOK_MASK, LOOK_BLEND };

struct look_material {
	char *name;
	double rgba[4], rough, metal, cutoff, normal_scale, glow[3];  // factors, as glTF's
	enum look_alpha alpha;
	bool two_sided;
	int map[LOOK_MAPS];     // texture; -1: none
};

/* A picture as the file has it: PNG or JPEG, its size checked. */
struct look_texture {
	char *name;
	int width, height;
	bool png;
	const uint8_t *bytes;   // in look.bytes
	long size;
};

/* Arrays are owned; look_free. */
struct look {
	int n_points, n_faces, n_wedges, n_parts, n_materials, n_textures, n_shapes;
	int32_t (*corner)[3];    // [n_faces] wedges
	int32_t *face_part, *face_material;  // [n_faces]; material -1: none
	int32_t *point;          // [n_wedges] row of the mesh
	float (*uv)[2];          // [n_wedges]; v downwards, as glTF's
	float (*normal)[3];      // [n_wedges] unit, at rest, the mesh's axes
	float (*rgba)[4];        // [n_wedges] colours of the vertices, linear; 1 where there are none
	char **part, **shape;    // names
	struct look_material *material;
	struct look_texture *texture;
	int32_t *shape_start;    // [n_shapes + 1] rows of the next two
	int32_t *shape_point;    // row of the mesh
	float (*shape_by)[3];    // its displacement, the mesh's unit and axes
	uint8_t *bytes;          // of all textures
	long n_bytes;
	char **left_out;         // sentences: what could not be kept
	int n_left_out;
	bool has_uv;
};

void look_free(struct look *look);

/* Writes and reads look.npz. made_by: JSON text or null. Return false, err set; look_load also when an array has another type or
 * shape, an index points nowhere, or a texture is no PNG or JPEG of at most 16384 px a side; look is empty then. */
bool look_save(const struct look *look, const char *path, const char *made_by, struct err *err);
bool look_load(struct look *look, const char *path, struct err *err);

/* The same in memory, for a process of its own (base/apart.h): put hands over a piece at a time; take reads what was put, and checks
 * as look_load. mesh: the surface, which goes along; mesh_free. */
struct apart_out;
bool look_put(const struct look *look, const struct mesh *mesh, struct apart_out *out);
bool look_take(struct look *look, struct mesh *mesh, const char *data, size_t size, struct err *err);

#endif
