/* lash: a portrait's lashes and brows (rig/hair/hair.h), as ribbons. */
#ifndef DRAW_FACE_LASH_H
#define DRAW_FACE_LASH_H
#include "draw/face/portrait.h"

/* make: grows the hairs at rest, appends their triangles to the mesh. move: places their vertices for the pose, as ribbons that face the
 * view's camera. colour: of one of their faces. cover: the share of what lies behind such a face that it hides: a hair thinner than
 * samples are apart is drawn as wide as that. */
void portrait_lashes_make(struct portrait *portrait);
void portrait_lashes_free(struct portrait *portrait);
void portrait_lashes_move(struct portrait *portrait, const struct portrait_view *view);
float portrait_lash_cover(const struct portrait *portrait, int face);
void portrait_lash_colour(float rgb[3], const struct portrait *portrait, int face);

/* Albedo that a hair is drawn with. A colour that was measured, of brows, has the sheen and the brighter tips, which drawing adds, in it. */
void portrait_lash_albedo(double rgb[3], const struct portrait *portrait, const struct hair *hair);

/* A hair's vertex relative to its root: the root is the weighted mean of three vertices of the mesh; local: off the globe, along the
 * lid, up over it (mm). vertex: row of the mesh. */
struct portrait_pin {
	int vertex[3], side;
	float weight[3], local[3];
};
void portrait_lash_pin(struct portrait_pin *pin, const struct portrait *portrait, int vertex);

#endif
