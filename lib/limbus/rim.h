/* rim: refines a rough limbus ellipse to a fraction of a pixel.
 * A robust edge search along the normals, then the blurred step fitted in every arc, then a geometric ellipse
 * through the arcs that show iris against sclera. Lids, lashes and glints are rejected by contrast, by residual and by distance.
 */
#ifndef LIMBUS_RIM_H
#define LIMBUS_RIM_H
#include "limbus/edge.h"
#include "math/ellipse_fit.h"

struct rim_conf {
	double search;        // first search range, share of the semi-axis
	double max_rms;       // residual of a step, in units of its height, beyond which an arc is rejected
	double min_contrast;  // of an arc's step, relative to the ring's median
	double irregularity;  // sigma that is added for the limbus' own irregularity, share of the step's width
	double colour_gain, rough_gain;  // of colour over brightness, from which it measures sharp steps, too; the same of a rough measure
	double coarse_straying;  // how many times more a rough measure strays
	double straying;      // the limbus is no ellipse: variance of centre and size for that of residuals that neighbours share
	double max_axis;      // px: larger limbi are measured in a reduced picture
	const struct ellipse_prior *known;  // what the evidence says of the ellipse before, or null; borrowed
	bool absolute;        // tint is a chance of sclera, not a whiteness that is relative to the ring's
	int passes;           // of the step fit: 6; fewer are rough
	double least_window;  // px: half-width of the steps looked at, at least, however small the ellipse
	bool grey;            // measure in brightness, not in the discriminant of propose/colour.h
};

struct rim {
	struct ellipse e;
	double cov_q[ELLIPSE_N][ELLIPSE_N];
	double width;            // sigma of the blurred step, px
	double widths[ARCS];     // the same along the ring
	double coverage;         // share of the ring that shows the step
	double share_used;       // share that is good enough to measure
	double rms;              // of the used arcs' distances, px
	double correlation;      // number of neighbouring arcs whose errors are correlated
	double contrast;         // median Weber contrast of the used arcs, linear light
	double out, in;          // median brightness outside and inside, linear
	struct step step[ARCS];
	bool used[ARCS], seen[ARCS];
	double p[ARCS][2], normal[ARCS][2];  // edge points, px of the photograph; outward
	double t[ARCS];          // eccentric angle of each arc
	double own_width[ARCS];  // of each arc alone, px; 0 where not measured
};

/* Refines the ellipse `start`.
 * rim   overwritten
 * tint  pyramid.tint, to separate sclera outside from skin; null where that does not matter (pupil)
 * False when no ellipse can be fitted near `start`. */
bool rim_fit(struct rim *rim, const struct photo *photo, const struct grey *tint, const struct ellipse *start,
             const struct rim_conf *conf);

#endif
