/* surface_colour: colours of a mesh from pictures with known cameras.
 */
#ifndef SFM_CLOUD_SURFACE_COLOUR_H
#define SFM_CLOUD_SURFACE_COLOUR_H
#include "mesh/mesh.h"
#include "optics/camera.h"

/* A picture for colouring: mesh frame, mm. */
struct surface_view {
	double cam_from_mesh[4][4];
	double focal[2], center_px[2], distortion[5];  // px of a picture of width x height
	int width, height;
};

/* Which views show each vertex best: best[n_vertices][SURFACE_BEST], -1 where there is none; facing, near, not hidden. */
enum { SURFACE_BEST = 3 };
void surface_best_views(int (*best)[SURFACE_BEST], const struct mesh *mesh, int n, const struct surface_view views[]);

/* Adds view k's colours, linear, to those vertices for which it is among the best; sum[n_vertices][4]: R G B and weight. */
void surface_add_colour(float (*sum)[4], const struct mesh *mesh, int k, const struct surface_view *view, const uint8_t *rgb,
                        int width, int height, const int (*best)[SURFACE_BEST]);

/* The colours from the sums; vertices no view shows take their neighbours'. */
void surface_set_colours(struct mesh *mesh, const float (*sum)[4]);

#endif
