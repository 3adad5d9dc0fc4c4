/* ai_scene: a character's file read by Assimp: glTF, FBX, OBJ and what else it knows. It reads strangers' bytes: to be called in a
 * process of its own (base/apart.h). Lengths in the file's own unit, axes the file's; nodes and skins applied as the file poses them.
 */
#ifndef BRIDGE_AI_SCENE_H
#define BRIDGE_AI_SCENE_H
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Textures of a material; in glTF's sense: AI_METAL holds roughness in green and metalness in blue. */
enum ai_map { AI_COLOUR, AI_NORMAL, AI_METAL, AI_EMISSIVE, AI_OCCLUSION, AI_MAPS };

struct ai_shape {
	char *name;
	float (*by)[3];         // [n] displacements
};

/* One mesh at one place of the scene, those vertices of it that its faces have; owned. */
struct ai_part {
	char *name;
	int n, n_faces, material, n_shapes;
	int node;               // parts of one node follow each other: one mesh of several materials
	float (*x)[3], (*normal)[3], (*uv)[2], (*rgba)[4];  // [n]; normal, uv, rgba may be null; v counts downwards, as glTF's
	int32_t (*face)[3];
	struct ai_shape *shape;
};

struct ai_material {
	char *name;
	float rgba[4], rough, metal, cutoff, normal_scale, emissive[3];
	int alpha;              // 0 opaque, 1 mask, 2 blend
	bool two_sided;
	int map[AI_MAPS];       // texture; -1: none
};

/* A picture as the file has it: PNG, JPEG ...; bytes null: it could not be read, and why. */
struct ai_texture {
	char *name, *why;
	unsigned char *bytes;
	size_t size;
};

struct ai_scene {
	int n_parts, n_materials, n_textures;
	struct ai_part *part;
	struct ai_material *material;
	struct ai_texture *texture;
};

/* A file of a folder; its ending says its kind. What it refers to is read from that folder, never from outside: an absolute path is taken for its last part. */
struct ai_file {
	const char *folder, *name;
	const void *bytes;      // what is to be read in its place, as a file of that name; null: the file itself
	size_t size;
};

/* scene   overwritten; never freed: its process ends
 * limit   most vertices and faces;  texture_bytes: most bytes of one texture
 * Returns false, err set, when Assimp cannot read it, it has no faces, or more than limit. */
bool ai_scene_read(struct ai_scene *scene, const struct ai_file *file, long limit, size_t texture_bytes, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
