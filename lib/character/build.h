/* build: surface and look from the scene that Assimp gives. */
#ifndef CHARACTER_BUILD_H
#define CHARACTER_BUILD_H
#include "bridge/ai_scene.h"
#include "character/look.h"

/* mesh, look   overwritten
 * given        [n_given] the vertices of the file in its order, which become the mesh's; null: those of the scene
 * Returns false, err set, when no face has an area of its own. */
bool character_build(struct mesh *mesh, struct look *look, const struct ai_scene *scene, const float (*given)[3], int n_given, struct err *err);

#endif
