/* fbx: a head and its eyeballs as an artist's FBX, in words (version 7400): head and eyeballs as meshes, a texture where the artist had it, a
 * blend shape, centimetres.
 */
#ifndef TESTS_SCENES_FBX_H
#define TESTS_SCENES_FBX_H
#include "tests/lib/scenes/dressed.h"

/* Writes the .fbx, and skin.png beside it, of how->texture_px; of how its unit and texture_px count. mesh: y up, the face towards +z. Returns
 * false, err set, when it cannot. */
bool fbx_write(const char *path, const struct mesh *mesh, const struct dressed *how, struct err *err);

#endif
