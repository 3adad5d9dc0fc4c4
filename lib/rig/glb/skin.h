/* glb_skin: the skin of a driven character as meshes of a glTF: with its own look, where it has one. For the files of this folder. */
#ifndef RIG_GLB_SKIN_H
#define RIG_GLB_SKIN_H
#include "character/look.h"
#include "rig/glb/bake.h"
#include "rig/glb/buffer.h"

/* Meshes, materials, textures of the skin: JSON arrays; owned, glb_skin_free. */
struct glb_skin {
	json_t *meshes, *materials, *images, *textures;
	int n;             // meshes
	double unit;       // mm: of length of all its meshes (targets.h)
	int *ours, *all;   // [n] whether the animation's targets are its first ones; how many targets it has
	double **gain;     // [n] of each mesh's animation targets (targets.h); null: as they are
};

/* look: null: one mesh of one colour. There is room for three more meshes. */
void glb_skin_make(struct glb_skin *skin, struct glb_buffer *buffer, const struct rig *rig, const struct glb_bake *bake,
                   const struct glb_conf *conf, const struct look *look);
void glb_skin_free(struct glb_skin *skin);

#endif
