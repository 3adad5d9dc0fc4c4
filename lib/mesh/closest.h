/* closest: the point of a triangle mesh closest to a given one, through Embree's point queries.
 *
 * Distance may be in six dimensions: |x - p|^2 + turn^2 |n - m|^2, with n the mesh's normal (interpolated between its
 * vertices) at x and m that of the query, so that the point found lies on a side that faces the same way.
 */
#ifndef MESH_CLOSEST_H
#define MESH_CLOSEST_H
#include "mesh/mesh.h"

struct closest_scene;

struct closest_point {
	int face;          // -1: none within reach
	float bary[3];     // weights of its corners, >= 0, sum 1
	float at[3];       // the point
	float normal[3];   // there, unit length; interpolated
	float distance;    // |at - query|, in three dimensions
};

/* Keeps pointers to the mesh and to its unit vertex normals (null: faces' own). Faces without area are left out; edges of
 * faces no longer than 1e-6 of the mesh. closest_free. */
struct closest_scene *closest_new(const struct mesh *mesh, const float (*normals)[3]);
void closest_free(struct closest_scene *scene);

/* Closest point within `reach` (in the measure's lengths). normal: of the query, unit length; null or turn = 0: in three
 * dimensions. guess: a face whose closest point bounds the search, or -1. Of equally close faces the first is taken. Any
 * number of threads at once. */
struct closest_point closest_find(const struct closest_scene *scene, const float at[3], const float normal[3], float turn,
                                  float reach, int guess);

#endif
