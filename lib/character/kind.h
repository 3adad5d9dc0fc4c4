/* kind: what a name in targets/ is, by its ending. Apart from what reads it: plan asks at every make, and does not load Assimp for it. */
#ifndef CHARACTER_KIND_H
#define CHARACTER_KIND_H
#include <stdbool.h>
#include <stddef.h>

/* CHARACTER_PLAIN: PLY and OBJ, a surface alone unless an OBJ names materials or a PLY its texture.
 * CHARACTER_SCENE: glTF (.glb, .gltf) and FBX. */
enum character_kind { CHARACTER_NONE, CHARACTER_PLAIN, CHARACTER_SCENE };
enum character_kind character_kind_of(const char *name);
bool character_is_gltf(const char *name);

/* Whether a file brings materials: a scene does; an OBJ that names them ("mtllib"), a PLY that names its texture ("comment TextureFile" in its
 * head). data[size]: the file, or as much of its beginning as is to be believed, a zero byte behind it. */
bool character_names_look(const char *name, const char *data, size_t size);

#endif
