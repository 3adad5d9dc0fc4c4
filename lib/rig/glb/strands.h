/* strands: lashes and brows as triangles: a lash is a tapered tube of three sides, a hair of a brow a tapered ribbon that lies on the skin. For the
 * files of this folder. */
#ifndef RIG_GLB_STRANDS_H
#define RIG_GLB_STRANDS_H
#include "rig/glb/skin.h"
#include "rig/hair/hair.h"

/* Vertices of all hairs. */
int strands_count(const struct hairs *hairs);

/* Where they are in a pose x[rig.n]: out[count][3], mm; normal[count][3], unit, may be null. Hairs follow each other in their order. */
void strands_place(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct rig *rig, const float (*x)[3]);

/* Appends the meshes `lashes` and `brows` with the bake's targets, and their material, to a skin that is made. Nothing where there are none. */
void strands_put(struct glb_skin *skin, struct glb_buffer *buffer, const struct rig *rig, const struct glb_bake *bake, const struct hairs *hairs,
                 const double rgb[3]);

#endif
