/* viewer_face_impl: what viewer_face.c and viewer_express.c share. */
#ifndef RENDER_VIEWER_FACE_IMPL_H
#define RENDER_VIEWER_FACE_IMPL_H
#include "render/viewer_face.h"
#include "skin/portrait_impl.h"

/* The grid of poses: horizontal, vertical, aperture; the pose at rest. MOST: vertices that move. */
enum { NH = 5, NV = 3, NA = 4, POSES = NH * NV * NA, SKY = 24, RECORD = 12, MOST = 9000, REST = (NA - 2) * NH * NV + NV / 2 * NH + NH / 2 };

struct face {
	const struct rig *rig;
	struct portrait *portrait;
	int n;
	double middle[3];
	int n_au;                        // expressions: a pose of each follows the grid's
	uint8_t **record;                // [POSES + n_au][n][RECORD]: x, y, z 16 bits each, normal 8 bits each, light red, green, blue
	uint8_t *sky;                    // [POSES][SKY][2 SKY]: left, right
	int *order, moving;              // vertices as the page has them: those that move first
	int least;                       // what counts as motion, in steps of 1/300 mm
};

json_t *viewer_base64(const void *bytes, size_t size);

/* Each expression in full: the vertices of the page's n that it changes, and how they are then. */
json_t *viewer_expressions(const struct face *face, int n, char *const names[]);

/* The maps of what folds, one below the other; follows: the expression that each belongs to. Nothing where nothing does. */
bool viewer_put_folds(json_t *out, const struct face *face, int n, struct err *err);

#endif
