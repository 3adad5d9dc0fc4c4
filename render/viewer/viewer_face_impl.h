/* viewer_face_impl: what the files of the page's character share. */
#ifndef RENDER_VIEWER_VIEWER_FACE_IMPL_H
#define RENDER_VIEWER_VIEWER_FACE_IMPL_H
#include "render/viewer/viewer_face.h"
#include "draw/face/parts.h"

/* The grid of poses on which light is kept: horizontal, vertical, aperture; the pose at rest. LEVELS: of the mesh, at most. */
enum { NH = 5, NV = 3, NA = 4, POSES = NH * NV * NA, SKY = 24, REST = (NA - 2) * NH * NV + NV / 2 * NH + NH / 2, LEVELS = 6 };

/* The page's vertices stand in this order: the rig's own, then those between two of these, then those between any of them and
 * so on, then hairs; of each level those first that do not always stand still. */
struct face_level {
	int first, posed, end;           // of the page's vertices
};

struct face {
	const struct rig *rig;
	struct portrait *portrait;
	int n;                           // vertices of the portrait's mesh, and behind them those of its hairs
	double middle[3];                // of both eyes
	int n_au;                        // expressions: a pose of each follows the grid's
	uint8_t (**light)[3];            // [POSES + n_au][rig n]: roots of irradiance
	uint8_t *sky;                    // [POSES + n_au][SKY][2 SKY]: left, right
	int n_shown, *order, *place;     // the page's vertices: the mesh's row; and back, -1: not on the page
	int n_levels;
	struct face_level level[LEVELS];
	int first_hair;
	int n_faces, n_ring;             // shown; and round the rig's own vertices
	uint32_t (*faces)[3], (*ring)[3];
};

/* viewer_order.c: which vertices the page has, and their order. viewer_order_free. */
void viewer_order(struct face *face, double reach_mm);
void viewer_order_free(struct face *face);

/* viewer_rig.c: algorithm 1's numbers (rig/deform/deform.h), for the page's shader to pose the mesh with. */
void viewer_put_rig(json_t *out, const struct face *face);

/* The maps of what folds, one below the other; follows: the expression that each belongs to. Nothing where nothing does. */
bool viewer_put_folds(json_t *out, const struct face *face, struct err *err);

#endif
