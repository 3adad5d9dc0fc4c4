/* surface_colour: colours of a mesh from pictures with known cameras.
 */
#ifndef SFM_CLOUD_SURFACE_COLOUR_H
#define SFM_CLOUD_SURFACE_COLOUR_H
#include "mesh/mesh.h"
#include "optics/camera.h"

/* The camera of a picture. cam_from_mesh: mm, in the mesh's frame. */
struct surface_view {
	double cam_from_mesh[4][4];
	double focal[2], center_px[2], distortion[5];  // px of a picture of width x height
	int width, height;
};

/* Selects for each vertex the views with the most pixels a millimetre of its surface, among those that face it and in which nothing
 * hides it. best: out, [n_vertices][SURFACE_BEST], best first, -1 where there is none. */
enum { SURFACE_BEST = 3 };
void surface_best_views(int (*best)[SURFACE_BEST], const struct mesh *mesh, int n, const struct surface_view views[]);

/* Adds view k's colours, linear, to the vertices for which it is among the best.
 * sum  [n_vertices][4]: R G B times weight, and weight; zero before the first view
 * rgb  8-bit sRGB, [height][width][3]: the picture of view->width x view->height, or a reduced one */
void surface_add_colour(float (*sum)[4], const struct mesh *mesh, int k, const struct surface_view *view, const uint8_t *rgb,
                        int width, int height, const int (*best)[SURFACE_BEST]);

/* Sets the mesh's colours from the sums. Vertices that no view shows take their neighbours' colours, else grey. */
void surface_set_colours(struct mesh *mesh, const float (*sum)[4]);

#endif
