/* lash: a portrait's lashes: hairs that stand on the lids' margins and go with them. */
#ifndef DRAW_FACE_LASH_H
#define DRAW_FACE_LASH_H
#include "draw/face/portrait.h"

/* Planted at rest; stretched out for a pose, as wide as they are towards that camera. */
void portrait_lashes_make(struct portrait *portrait);
void portrait_lashes_move(struct portrait *portrait, const struct portrait_view *view);
void portrait_lash_colour(float rgb[3], const struct portrait *portrait, int face);

/* Where a hair's vertex stands now in the frame that its root carries along: off the globe, along the lid, up over it (mm). The
 * root: a point of three vertices of the mesh. */
struct portrait_pin {
	int vertex[3], side;
	float weight[3], local[3];
};
void portrait_lash_pin(struct portrait_pin *pin, const struct portrait *portrait, int vertex);

#endif
