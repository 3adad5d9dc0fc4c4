/* closest: the point of a triangle mesh closest to a given one, by Embree's point queries. Lengths in the mesh's unit.
 *
 * The distance may include normals: |x - p|^2 + turn^2 |n - m|^2, with n the mesh's normal at x (interpolated between vertices)
 * and m that of the query, so that the point found lies on a side that faces the same way.
 */
#ifndef MESH_CLOSEST_H
#define MESH_CLOSEST_H
#include "mesh/mesh.h"

struct closest_scene;

struct closest_point {
	int face;          // of the mesh; -1: none within reach
	float bary[3];     // weights of its corners, >= 0, sum 1
	float at[3];       // the point
	float normal[3];   // there, unit length; interpolated
	float distance;    // |at - query|, in three dimensions
};

/* Builds the search tree. closest_free. Faces without area (height at most 1e-7 of an edge) are left out.
 * mesh     borrowed until closest_free
 * normals  [n_vertices] unit normals, borrowed too; null: those of the faces */
struct closest_scene *closest_new(const struct mesh *mesh, const float (*normals)[3]);
void closest_free(struct closest_scene *scene);

/* Finds the closest point within `reach`, in the metric above.
 * normal  of the query, unit length; null: distance in three dimensions
 * turn    weight of the normals, a length; 0: distance in three dimensions
 * guess   a face whose closest point bounds the search, or -1
 * Of equally close faces the first is taken. Any number of threads at once. */
struct closest_point closest_find(const struct closest_scene *scene, const float at[3], const float normal[3], float turn,
                                  float reach, int guess);

#endif
