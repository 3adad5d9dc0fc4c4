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

/* Triangles of the hairs [from, to), whose vertices are numbered from 0: face[strands_most_faces][3]; returns how many. */
int strands_faces(uint32_t (*face)[3], const struct hairs *hairs, int from, int to);
int strands_most_faces(const struct hairs *hairs);

json_t *strands_material(const double rgb[3]);

/* Appends the meshes `lashes` and `brows` with the bake's targets, and their material, to a skin that is made. Nothing where there are none. */
void strands_put(struct glb_skin *skin, struct glb_buffer *buffer, const struct rig *rig, const struct glb_bake *bake, const struct hairs *hairs,
                 const double rgb[3]);

/* Appends a mesh of the last material: n vertices x and normals at rest, triangles of them; its targets are the rows of the bake's hairs from
 * `first` on. */
void strands_put_mesh(struct glb_skin *skin, struct glb_buffer *buffer, const struct glb_bake *bake, const char *name, int first, int n, const float (*x)[3],
                      const float (*normal)[3], const uint32_t (*face)[3], int n_faces);

#endif
