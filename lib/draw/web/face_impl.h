/* face_impl: private to the files that make a character for the interactive page. */
#ifndef DRAW_WEB_FACE_IMPL_H
#define DRAW_WEB_FACE_IMPL_H
#include "draw/face/parts.h"
#include "draw/web/face.h"

/* The grid of poses for which light is computed: NH horizontal and NV vertical gazes, NA apertures; REST: the pose at rest. SKY: cells
 * across a globe. LEVELS: of subdivision, at most. */
enum { NH = 5, NV = 3, NA = 4, POSES = NH * NV * NA, SKY = 24, REST = (NA - 2) * NH * NV + NV / 2 * NH + NH / 2, LEVELS = 6 };

/* The page's vertices stand in this order: the rig's own, then those between two of these (the first level of subdivision), then
 * those between any of them and so on, then hairs. Of each level those come first that move, or whose light changes. */
struct web_level {
	int first, posed, end;           // [first, posed): those that move; [posed, end): those that stand still
};

struct web_face {
	const struct rig *rig;
	struct portrait *portrait;
	int n;                           // vertices of the portrait's mesh, and behind them those of its hairs
	double middle[3];                // of both eyes
	int n_au;                        // expressions: a pose of each follows the grid's
	uint8_t (**light)[3];            // [POSES + n_au][rig n]: roots of irradiance
	uint8_t (*sky)[4];               // [POSES + n_au][SKY][2 SKY]: left, right; share and middle of what lids leave of it
	int n_lid, *lid, *settled_as;    // settle.c: the lids' vertices that it moves, rows of the rig; of each row its number there plus 1, 0: none
	int n_shown, *order, *place;     // the page's vertices: the mesh's row; and back, -1: not on the page
	int n_levels;
	struct web_level level[LEVELS];
	int first_hair;
	int n_faces, n_ring;             // shown; the rig's own, for its vertices' normals
	uint32_t (*faces)[3], (*ring)[3];
};

/* order.c: selects the vertices whose faces lie within reach_mm of the middle of the eyes, and those that they are made from; fills
 * n_shown to ring. web_order_free. */
void web_order(struct web_face *face, double reach_mm);
void web_order_free(struct web_face *face);

/* settle.c: how far deform_settle moves lids, in poses of a grid of its own; fills lid and settled_as, which rig.c reads. */
void web_settle_put(json_t *out, struct web_face *face);
void web_settle_free(struct web_face *face);

/* rig.c: the numbers of algorithm 1 (rig/deform/deform.h), with which the page's shader poses the mesh. */
void web_put_rig(json_t *out, const struct web_face *face);

/* dress.c: the character's own colours as one map; nothing where it has none. False, err set, when it cannot be encoded. */
bool web_put_dress(json_t *out, const struct web_face *face, struct err *err);

/* folds.c: wrinkle maps that fold with an expression, one below the other, and which expression each follows; nothing where there
 * are none. Returns false, err set, when they cannot be encoded. */
bool web_put_folds(json_t *out, const struct web_face *face, struct err *err);

#endif
