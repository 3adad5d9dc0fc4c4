/* tears: the meniscus of tears along a lower lid as triangles: a quarter of a circle, flat on the eyeball and upright on the lid, as the
 * renderer draws it (draw/face/tear.c). For the files of this folder, and an eye that leaves alone. */
#ifndef RIG_GLB_TEARS_H
#define RIG_GLB_TEARS_H
#include "rig/glb/skin.h"
#include "rig/hair/hair.h"

/* Vertices: TEARS_SECTION across at every place of a rim. */
enum { TEARS_SECTION = 5 };
int tears_count(const struct hairs *hairs);

/* Where they are in a pose x[rig.n], the globes turned so: out[count][3], mm; normal[count][3], unit, may be null.
 * height  of the meniscus, mm; it is lower towards the corners, and where the upper lid comes down to it
 * over    mm that the eyeball drawn stands over the rig's globe */
void tears_place(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct rig *rig, const float (*x)[3],
                 const double target_from_globe[2][3][3], double height, double over);
/* The same at rest, both globes looking ahead. */
void tears_rest(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct rig *rig, double height, double over);

/* Its triangles, face[2 tears_count()][3], looking outwards; returns how many. first: the number of its first vertex. */
int tears_faces(uint32_t (*face)[3], const struct hairs *hairs, uint32_t first);

/* Clear and wet: KHR_materials_transmission, _ior, which the file has to name. */
json_t *tears_material(void);

/* Appends the mesh `tears`, with the bake's targets, and its material to a skin that is made; used: the names of extensions, each once.
 * Its vertices follow the strands in the bake. Nothing where there are none. */
void tears_put(struct glb_skin *skin, struct glb_buffer *buffer, const struct rig *rig, const struct glb_bake *bake, const struct glb_conf *conf, json_t *used);

#endif
