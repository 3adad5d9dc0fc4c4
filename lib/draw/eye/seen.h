/* seen: what is known of the colours of an iris that was not fitted (scene_plain): as far as it was seen they are its own; what is finer than was seen,
 * and the rest, is drawn in their manner. */
#ifndef DRAW_EYE_SEEN_H
#define DRAW_EYE_SEEN_H
#include "base/err.h"

enum { SEEN_SIDE = 512, SEEN_RINGS = 96, SEEN_TURNS = 192 };

/* A map of the plane of the iris about its axis, [SEEN_SIDE][SEEN_SIDE], row 0 at -y. */
struct scene_seen {
	double extent;     // half-width, mm
	float (*ln)[3];    // ln of colour over white, linear Rec. 709; owned
	float *weight;     // 0..1 how well it was seen; owned
	double pupil;      // radius, mm; 0: not seen
	double limbus;     // radius, mm
	double finest;     // mm: sigma of the blur it was seen with
};
void scene_seen_free(struct scene_seen *seen);

/* Completes it: ln of every texel within the limbus, also where weight is 0. drawn [SEEN_SIDE][SEEN_SIDE] ln of green of an invented iris of the same map, whose fibres stand
 * for what is finer than was seen. */
void scene_seen_fill(struct scene_seen *seen, const float *drawn);

#endif
