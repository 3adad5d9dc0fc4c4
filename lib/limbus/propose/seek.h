/* seek: candidates for the limbus in a photograph, coarse to fine, without a hint.
 * A limbus is an ellipse that is dark inside and bright outside along a good part of its edge. Centres come from votes of brightness
 * gradients along their own direction (fast radial symmetry, Loy and Zelinsky 2003, dark side only); ellipses around them by hill
 * climbing of score.h on the pyramid level where their radius is 14 to 60 px.
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

/* Finds at most conf->candidates ellipses, best first; returns how many.
 * hint  x, y, radius px, or null: restricts centres to half its radius and radii to a factor 1.5 */
int limbus_seek(struct seek_found out[SEEK_MAX], const struct pyramid *pyramid, const double *hint,
                const struct seek_conf *conf);

/* The best ellipse round `inner`: if that is a pupil, its limbus. False when none has any support. */
bool limbus_seek_outer(struct seek_found *out, const struct pyramid *pyramid, const struct ellipse *inner,
                       const struct seek_conf *conf);

/* Index of the finest level on which a radius (photo px) is at most `px` level pixels; the coarsest where it is larger on all. */
int pyramid_index(const struct pyramid *pyramid, double radius, double px);

#endif
