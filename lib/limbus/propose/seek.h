/* limbus_seek: where in the photograph the eye may be. Coarse to fine, no hint needed.
 * A limbus is an ellipse dark inside and bright outside along a good part of its edge. Centres come from votes of
 * brightness gradients along their own line (fast radial symmetry, Loy and Zelinsky 2003, dark side only), ellipses
 * around them from climbing an edge score on the pyramid level where their radius is 14 to 60 px.
 */
#ifndef LIMBUS_PROPOSE_SEEK_H
#define LIMBUS_PROPOSE_SEEK_H
#include "limbus/image.h"

struct seek_conf {
	double min_radius;   // smallest limbus looked for, share of the photograph's longer side
	double max_radius;   // largest, share of the shorter side
	double contrast;     // Weber contrast (out - in) / (out + in) of encoded brightness that counts as full support
	int candidates;      // ellipses kept
};

struct seek_found {
	struct ellipse e;  // px of the photograph
	double score;      // 0..1: share of the edge that is supported, weighted by contrast
};

enum { SEEK_MAX = 12 };

/* Writes at most conf->candidates ellipses, best first; returns how many.
 * hint: x, y, radius in px, or null: only centres within half a radius and radii within a factor 1.5 of it. */
int limbus_seek(struct seek_found out[SEEK_MAX], const struct pyramid *pyramid, const double *hint,
                const struct seek_conf *conf);

/* The best ellipse round `inner`: where that is a pupil, its limbus. False: none with any support. */
bool limbus_seek_outer(struct seek_found *out, const struct pyramid *pyramid, const struct ellipse *inner,
                       const struct seek_conf *conf);

/* Index of the level on which a radius is nearest below `px` pixels, or of the finest. */
int pyramid_index(const struct pyramid *pyramid, double radius, double px);

#endif
