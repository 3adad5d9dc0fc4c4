/* iris: the pattern and colour of a drawn iris. */
#ifndef EVIDENCE_IRIS_H
#define EVIDENCE_IRIS_H
#include "field.h"
#include "math/rng.h"

/* The last is drawn in the test split alone. */
enum iris_family { IRIS_FIBRES, IRIS_CRYPTS, IRIS_FURROWS, IRIS_PLAIN, IRIS_PRINTED, IRIS_BUNDLES, IRIS_FAMILIES };

enum { FRECKLES_MAX = 10 };

struct iris {
	enum iris_family family;
	const struct field *fine, *coarse;
	float outer[3], inner[3], gap[3];  // albedo outside and inside of the collarette, in the depth between fibres
	float contrast, fibres, warp, at[2];
	float collarette, wobble, ring, ring_width;  // its radius as a share of the way from pupil to root; dark limbal ring
	int n_freckles;
	float freckle[FRECKLES_MAX][4];  // share of the way, angle, radius, strength
};

struct iris iris_make(struct rng *rng, bool test);

/* Albedo at `share` of the way from the pupil's margin (0) to the root (1), angle in radians. */
void iris_albedo(float out[3], const struct iris *iris, float share, float angle);

#endif
