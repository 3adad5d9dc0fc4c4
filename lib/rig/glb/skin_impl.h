/* skin_impl: a skin's meshes on their way into a glTF, by file. */
#ifndef RIG_GLB_SKIN_IMPL_H
#define RIG_GLB_SKIN_IMPL_H
#include "rig/glb/skin.h"
#include "rig/glb/targets.h"

/* One mesh of the file: its rows are wedges of the look, or vertices of the rig where that has none. */
struct part {
	int n, *vertex, *wedge;    // [n] rows of the rig and of the look
	const char *name;
	struct glb_targets targets;
	json_t *primitives, *zero;
};

/* What it is made from. */
struct maker {
	struct glb_buffer *g;
	const struct rig *rig;
	const struct glb_bake *bake;
	const struct look *look;
	int plain;                 // the material of faces that the look gives none; the lining's is the next
	double unit;               // mm
	int *moving;               // [rig.n] row of the bake; -1: it does not move
	float (*rest)[3];          // [rig.n] normals of the surface at rest
};

/* skin_attributes.c: the attributes of a part, and a primitive of each material in it. corner: [n_faces][3] rows of the part; material:
 * [n_faces], below n_materials. */
void skin_put_primitives(struct maker *maker, struct part *part, int n_faces, const uint32_t (*corner)[3], const int *material, int n_materials);

/* skin_targets.c: the animation's targets and the named poses; returns whether any vertex of the part moves. A blend shape of the
 * character's own, on those parts that it moves. The names of ARKit that nothing moves: zero targets, listed. */
bool skin_put_ours(struct maker *maker, struct part *part);
void skin_put_own(struct maker *maker, struct part *parts, int n_parts, int shape);
void skin_put_zero(struct maker *maker, struct part *part);

/* skin_materials.c: the look's materials and textures, and one of one colour behind them; with a lining mucous membrane after that. */
void skin_put_materials(struct glb_skin *skin, struct glb_buffer *buffer, const struct look *look, bool lining, const struct glb_conf *conf);

#endif
