/* nricp_match: where on the fixed mesh a point of the moving one belongs, and how sure that is. */
#ifndef REGISTER_NRICP_MATCH_H
#define REGISTER_NRICP_MATCH_H
#include "mesh/closest.h"
#include "mesh/kdtree.h"
#include "mesh/topology.h"
#include "register/nricp/nricp.h"
#include "register/nricp/solve.h"

/* The fixed mesh, prepared. */
struct nricp_fixed {
	const struct mesh *mesh;
	float (*normals)[3];
	struct topology topology;
	struct closest_scene *scene;
	struct kdtree *rim_tree;   // middles and ends of its rim; null: it has none
	float (*rim)[3], (*rim_out)[3], (*rim_along)[3];  // points; unit directions off the surface there, and along it
	int n_rim;
	double noise;              // of the mesh, across its surface: standard deviation
};

void nricp_fixed_make(struct nricp_fixed *out, const struct mesh *mesh);
void nricp_fixed_free(struct nricp_fixed *fixed);

/* Unit directions off the surface at boundary vertices, smoothed along the rim; 0 elsewhere. */
void nricp_outward(float (*out)[3], const struct mesh *mesh, const struct topology *topology, const float (*normal)[3]);

/* A point of the moving mesh as it stands. */
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
	bool on_rim;       // its goal is a place of the fixed mesh's rim: pulls from all sides
};

/* scale: Welsch's, in the mesh's unit. match[].face of the round before bounds the search. */
void nricp_match_all(struct nricp_match *match, int n, const struct nricp_point *points, const struct nricp_fixed *fixed,
                     const struct nricp_conf *conf, double scale);

#endif
