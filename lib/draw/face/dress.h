/* dress: the textures of a character's own look, ready to be looked up. */
#ifndef DRAW_FACE_DRESS_H
#define DRAW_FACE_DRESS_H
#include "character/look.h"

struct dress;

/* What a point of a surface has of its own. */
struct dress_point {
	float rgb[3], alpha;     // linear albedo; opacity, 0 or 1 where the material cuts
	float tilt[3];           // normal in the tangent's frame: along u, along smaller v, outwards; (0, 0, 1) without a normal map
	float rough;             // 0..1
	bool bumpy;              // there is a normal map
};

/* Decodes the textures that the pictures need, at most `longest` px a side. look: must outlive it. A texture that cannot be decoded is
 * left out, and the first reason kept in why, where that is empty. dress_free, which accepts null. */
struct dress *dress_new(const struct look *look, int longest, struct err *why);
void dress_free(struct dress *dress);
const struct look *dress_look(const struct dress *dress);

/* A point of a material (-1: none) at texture coordinates. wide: width of what is looked at there, in texture coordinates; of coarser
 * levels of the textures that one is read whose texels are as wide. */
void dress_at(struct dress_point *out, const struct dress *dress, int material, const float uv[2], float wide);

/* Whether a material shows what is behind it anywhere. */
bool dress_cuts(const struct dress *dress, int material);

#endif
