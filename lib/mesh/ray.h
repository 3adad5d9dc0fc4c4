/* ray: first intersections of rays with a triangle mesh (Embree). */
#ifndef MESH_RAY_H
#define MESH_RAY_H
#include "mesh/mesh.h"

struct ray_scene;

struct ray_hit {
	float t;       // along the direction
	int face;      // -1: none
	float u, v;    // barycentric: weights of the face's second and third corner
};

/* Builds the search tree of a mesh, which is copied. An empty mesh is allowed and never hit. ray_scene_free. */
struct ray_scene *ray_scene_new(int n_vertices, const float (*vertices)[3], int n_faces, const int32_t (*faces)[3]);
void ray_scene_free(struct ray_scene *scene);

/* Moves the vertices; the faces stay the same. */
void ray_scene_move(struct ray_scene *scene, const float (*vertices)[3]);

/* First hit of origin + t dir with near <= t <= far. Any number of threads at once. */
struct ray_hit ray_first(const struct ray_scene *scene, const float origin[3], const float dir[3], float near, float far);

/* Whether there is any hit between near and far. */
bool ray_blocked(const struct ray_scene *scene, const float origin[3], const float dir[3], float near, float far);

#endif
