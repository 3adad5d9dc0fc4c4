/* nricp_match: correspondences: for each point of the moving mesh its place on the fixed mesh, with a weight. */
#ifndef REGISTER_NRICP_MATCH_H
#define REGISTER_NRICP_MATCH_H
#include "mesh/closest.h"
#include "mesh/kdtree.h"
#include "mesh/topology.h"
#include "register/nricp/nricp.h"
#include "register/nricp/solve.h"

/* The fixed mesh with its search structures. nricp_fixed_free; mesh is the caller's. */
struct nricp_fixed {
	const struct mesh *mesh;
	float (*normals)[3];
	struct topology topology;
	struct closest_scene *scene;
	struct kdtree *rim_tree;   // of rim; null: the mesh has no boundary
	float (*rim)[3], (*rim_out)[3], (*rim_along)[3];  // points on the boundary; unit directions off the surface there, and along it
	int n_rim;
	double noise;              // standard deviation of the mesh's noise across its surface (nricp_noise)
};

void nricp_fixed_make(struct nricp_fixed *out, const struct mesh *mesh);
void nricp_fixed_free(struct nricp_fixed *fixed);

/* Unit directions off the surface at boundary vertices, in its tangent plane and smoothed along the boundary; 0 elsewhere.
 * out[vertices]; normal[vertices]: the mesh's. */
void nricp_outward(float (*out)[3], const struct mesh *mesh, const struct topology *topology, const float (*normal)[3]);

/* A point of the moving mesh at its current place. */
struct nricp_point {
	float at[3], normal[3];
	float out[3];      // unit direction off the surface, at its boundary
	bool boundary;
};

struct nricp_match {
	int face;          // of the fixed mesh, -1: none
	float bary[3];     // weights of its corners at the closest point
	float goal[3];
	float normal[3];   // there; of a rim, the direction along it
	float weight;      // 0..1
	bool on_rim;       // matched to the fixed mesh's boundary: distances count in all directions
};

/* Matches n points: each to the closest place of a like normal, boundary points to the boundary. Weights are Welsch's, exp(-d^2 /
 * scale^2) of the distance d across the surface; 0 where the normals differ or the surface ends.
 * match  [n] out; in: face of the round before, which bounds the search (-1: none)
 * conf   its lengths, and scale, in the meshes' unit */
void nricp_match_all(struct nricp_match *match, int n, const struct nricp_point *points, const struct nricp_fixed *fixed,
                     const struct nricp_conf *conf, double scale);

#endif
