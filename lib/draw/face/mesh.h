/* mesh: the triangles of a portrait. */
#ifndef DRAW_FACE_MESH_H
#define DRAW_FACE_MESH_H
#include <stdbool.h>
#include <stdint.h>

struct portrait;

/* The skin's triangles, subdivided near the eyes. The first rig.n vertices are the rig's; each further one is the middle of an edge
 * between two earlier ones. Arrays are owned; [n] where nothing else is said. */
struct portrait_mesh {
	int n, n_faces, n_base;
	int (*between)[2];          // [n - n_base]
	int32_t (*faces)[3];
	float (*x)[3], (*normal)[3], (*rest)[3], (*bare)[3], (*light)[3], (*albedo)[3];  // bare: light before skin spreads it
	float *open;                // share of the light that is not shadowed
	float *wet;                 // moisture, 0..1
	float (*home)[2];           // where the modelling camera sees it at rest, px; null without wrinkles
	// Of a character with textures of its own; n_dressed 0 without. [n_dressed]: the faces, but for those of lining and lashes
	int n_dressed;
	float (*uv)[3][2];
	int16_t *material;          // -1: none
	bool *cuts;                 // shows what is behind it somewhere
	float *uv_per_mm;
};

/* make: topology and vertices at rest. move: normals and subdivided vertices from the rig's posed vertices. */
void portrait_mesh_make(struct portrait *portrait);
void portrait_mesh_move(struct portrait *portrait);
void portrait_mesh_free(struct portrait_mesh *mesh);

/* Barycentric weights of the point where a ray meets a face's plane, clamped to the face. */
void portrait_mesh_weights(float w[3], const struct portrait_mesh *m, int face, const float origin[3], const float dir[3]);

#endif
