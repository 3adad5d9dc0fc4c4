/* graft: the meshes of a whole binary glTF, put into another one on its way. */
#ifndef RIG_GLB_GRAFT_H
#define RIG_GLB_GRAFT_H
#include "rig/glb/buffer.h"

/* What a file's root takes over; each an array on its way, made by the caller. used: names of extensions, each once. */
struct glb_arrays {
	json_t *meshes, *materials, *images, *textures, *samplers, *used;
};

/* Appends the buffer views, accessors, pictures, materials and meshes of a binary glTF with their numbers shifted; its nodes, scenes and
 * animations stay behind.
 * first  number of its first mesh in to->meshes, out
 * Returns how many meshes came; 0, err set, where the bytes are no binary glTF of one buffer. */
int glb_graft(struct glb_buffer *buffer, const struct glb_arrays *to, const void *bytes, size_t size, int *first, struct err *err);

#endif
