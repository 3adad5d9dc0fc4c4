/* mesh: the triangles that a portrait is drawn of. */
#ifndef DRAW_FACE_MESH_H
#define DRAW_FACE_MESH_H
#include <stdint.h>

struct portrait;

/* Drawn triangles: the skin's, near the eyes cut in four. The first rig.n vertices are the rig's; each further one lies
 * between two of them. */
struct portrait_mesh {
	int n, n_faces, n_base;
	int (*between)[2];          // [n - n_base]
	int32_t (*faces)[3];
	float (*x)[3], (*normal)[3], (*rest)[3], (*bare)[3], (*light)[3], (*albedo)[3];  // bare: light before skin spreads it
	float *open;                // share of the light that reaches it
	float *wet;                 // how moist it is, 0..1
	float (*home)[2];           // where the modelling camera sees it at rest, px; null without wrinkles
};

/* Topology once, vertices for each pose. */
void portrait_mesh_make(struct portrait *portrait);
void portrait_mesh_move(struct portrait *portrait);
void portrait_mesh_free(struct portrait_mesh *mesh);

/* Where in the face a ray meets its plane: weights of its vertices. */
void portrait_mesh_weights(float w[3], const struct portrait_mesh *m, int face, const float origin[3], const float dir[3]);

#endif
