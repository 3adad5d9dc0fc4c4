/* lighting: the light of one picture of an eye: an environment map, and the directions that stand for it. */
#ifndef DRAW_EYE_LIGHTING_H
#define DRAW_EYE_LIGHTING_H
#include "image/envmap/envmap.h"

struct scene_lighting {
	const struct envmap *env;     // in the camera's frame
	const struct envmap *mirror;  // what cornea and tear film mirror: usually env; null: nothing
	int n, each;                  // directions; so many neighbours of them go into the eye as one beam (0: 1)
	struct envmap_light light[ENVMAP_LIGHTS_MAX];  // in the camera's frame
};

/* Samples env by `lights` beams, each of up to `each` directions (a power of two; ENVMAP_LIGHTS_MAX directions altogether at
 * most). env and mirror must outlive the lighting. */
struct scene_lighting scene_lighting_of(const struct envmap *env, const struct envmap *mirror, int lights, int each);
/* The same with beams of up to eight directions. */
struct scene_lighting scene_lighting(const struct envmap *env, const struct envmap *mirror, int lights);

#endif
