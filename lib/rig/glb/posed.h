/* posed: displacements of one pose of a bake: of skin, of its normals, of hairs. For the files of this folder. */
#ifndef RIG_GLB_POSED_H
#define RIG_GLB_POSED_H
#include "rig/glb/bake.h"
#include "rig/glb/poser.h"

/* [bake.n][3], [bake.n][3], [bake.n_hair][3], mm. */
struct posed {
	float *x, *lean, *hair;
};

/* Not filled; posed_free. */
struct posed posed_new(const struct glb_bake *bake);
void posed_free(struct posed *posed);

/* The pose that the poser is in. */
void posed_take(struct posed *to, const struct poser *poser, const struct glb_bake *bake);

/* A pose of the bake, which owns it. */
struct posed posed_of(const struct glb_bake *bake, int pose);

#endif
