/* figure_mesh: a shaded mesh in a picture.
 */
#ifndef SFM_FIGURE_FIGURE_MESH_H
#define SFM_FIGURE_FIGURE_MESH_H
#include "bridge/cv_draw.h"
#include "mesh/mesh.h"

/* Draws the mesh in a square of `size` px at (x0, y0), from the front turned by `turn` radians about y, lit from the viewer's
 * upper left, in its own colours. */
void figure_mesh(struct cv_picture *pic, int x0, int y0, int size, const struct mesh *mesh, double turn);

#endif
