/* parts: what a portrait consists of, for the files that draw it and for the interactive page, whose shaders draw the same. Frame: the
 * rig's, mm. */
#ifndef DRAW_FACE_PARTS_H
#define DRAW_FACE_PARTS_H
#include "draw/face/lash.h"
#include "draw/face/mesh.h"
#include "draw/face/portrait.h"
#include "mesh/ray.h"
#include "rig/deform/arc.h"

struct portrait {
	const struct rig *rig;
	const struct scene *eye[2];
	const struct envmap *env;
	struct portrait_conf conf;
	struct deform *deform;
	struct deform_near lids;
	struct portrait_mesh mesh;
	struct ray_scene *shadow;   // the skin's own triangles
	int32_t (*solid)[3];        // their vertices
	float (*direct)[3];         // irradiance at the rig's vertices that no skin sends
	float (*lit)[3];            // all of it, before it is spread
	float (*lit_at)[3];         // where they were then
	int *near_start, *near;     // neighbours of the rig's vertices
	float *spread;              // diffusion weight of each neighbour, for red
	struct portrait_fringe *fringe[2];  // the hairs about each eye in the light of the last portrait_light; null before that
	double target_from_globe[2][3][3];
	struct hairs hairs;         // their triangles are the mesh's last, from first_lash; their vertices, two a point, from lash_vertex
	int first_lash, lash_vertex;
	int *hair_of, *hair_piece;  // [hairs.n_points] the hair of a point; the first point of each four triangles
	float *hair_cover;          // [hairs.n_points] of a hair as thick as it is, by one as thick as it is drawn
	const struct wrinkle_maps *wrinkles;
	int *wrinkle_input;         // [wrinkles.n] control that each map follows; -1: none
	float *wrinkle_strength;    // in this pose
	bool folded;                // any map shows in this pose
	bool matte;                 // nothing mirrors
	float corner[2][3];         // the globes' inner corners at rest, where known
	bool corner_known[2];
};

#endif
