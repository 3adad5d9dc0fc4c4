/* glb_targets: morph targets of one mesh. Displacements are whole steps (KHR_mesh_quantization), 16 bits of a length that one file's
 * meshes share, and only of vertices that move by half a step; those of normals 8 bits, and at most 1 along an axis: what turns further than that, folds that
 * come out, is drawn in. A target that goes further than the unit is of floats. */
#ifndef RIG_GLB_TARGETS_H
#define RIG_GLB_TARGETS_H
#include "character/look.h"
#include "rig/glb/bake.h"
#include "rig/glb/buffer.h"

/* Targets and their names, JSON arrays; owned. */
struct glb_targets {
	json_t *list, *names;
};

/* The unit of length of a file's skins and hairs: the largest displacement along an axis of all their targets, at most 500 mm, so that a
 * step is 1 / 32767 of it; a metre where nothing moves. look may be null. */
double glb_unit(const struct glb_bake *bake, const struct look *look);

/* Which of n targets of a mesh without normals are 8 bits, made as large as the unit first by gain >= 1, so that their weights are as much
 * smaller: the smallest ones, as many as move no vertex by more than 0.03 mm off with all weights at 1. most: [n] their largest displacement,
 * mm; gain: [n] out, 0 where a target is 16 bits as it is. */
void glb_targets_small(double *gain, const double *most, int n, double unit);

struct glb_targets glb_targets_new(void);
void glb_targets_free(struct glb_targets *targets);

/* Appends a target of n vertices: displacements by[n][3], mm, and those of normals lean[n][3], or null. gain: of glb_targets_small, or 0. */
void glb_targets_add(struct glb_targets *targets, struct glb_buffer *buffer, const char *name, const float *by, const float *lean, int n, double unit,
                     double gain);

/* Appends one that moves nothing, n_names times, each by its name. normals: it says so of normals, too. */
void glb_targets_add_zero(struct glb_targets *targets, struct glb_buffer *buffer, const char *const *names, int n_names, bool normals, int n);

/* Sets the targets of a mesh's primitives, its weights (0) and in extras the targets' names, and which are driven by others (bake.h); nothing where there are none. Returns how many. */
int glb_targets_put(const struct glb_targets *targets, json_t *mesh, const struct glb_bake *bake);

#endif
