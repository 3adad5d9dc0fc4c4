/* sky: what lids and brow leave of the light from all sides over the eye. */
#ifndef DRAW_FACE_SKY_H
#define DRAW_FACE_SKY_H
#include "draw/face/parts.h"

/* Share of the sky that lids and brow leave over a place of an eye, weighted by the cosine, by fixed directions; middle: the unit direction about which it lies,
 * the normal where none is left. at, normal: the rig's axes. */
float portrait_sky_over(float middle[3], const struct portrait *portrait, const float at[3], const float normal[3]);

/* Directions about a normal, spread by their cosine with it (golden angle). ray: the k-th of so many, unit; returns its cosine. */
struct portrait_fan {
	float normal[3], across[3], up[3];
};
struct portrait_fan portrait_fan_of(const float normal[3]);
float portrait_fan_ray(float dir[3], const struct portrait_fan *fan, int k, int rays);

#endif
