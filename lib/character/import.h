/* import: a character from the file an artist has: glTF, FBX, OBJ with materials. */
#ifndef CHARACTER_IMPORT_H
#define CHARACTER_IMPORT_H
#include "character/kind.h"
#include "character/look.h"

/* Whether a file is to be read by character_import: a scene, an OBJ that names materials, a PLY that names its texture
 * ("comment TextureFile NAME" in its head). */
bool character_has_look(const char *path);

struct character_limits {
	long vertices;    // most vertices and faces
	double seconds;   // of processor time for reading
	double mib;       // of memory for reading
};

/* Reads a character by Assimp, in a process of its own that can read its folder and nothing else (base/apart.h).
 * mesh   its surface: the file's unit and axes, all its meshes together, vertices at one place joined within a mesh where its blend
 *        shapes move them alike; of an OBJ or PLY the vertices are the file's, in its order. No colours. mesh_free
 * look   all else; look_free
 * folder, name   of the file
 * Returns false, err set ("folder/name: rule broken"), both empty, when it cannot be used. */
bool character_import(struct mesh *mesh, struct look *look, const char *folder, const char *name, const struct character_limits *limits,
                      struct err *err);

#endif
