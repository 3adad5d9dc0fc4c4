/* known: the gazes at which a clip shows somebody's lids. A linear model of lids holds there; far from them its slopes, which a clip that hardly
 * moves leaves to chance, would carry lids over the pupil. So lids are driven by the nearest gaze that is known, and a little further; the eyes
 * themselves turn as they are told.
 */
#ifndef MODEL_KNOWN_H
#define MODEL_KNOWN_H
#include "base/err.h"

enum { KNOWN_CORNERS = 16 };

/* Angles in degrees; [0] left eye, [1] right. */
struct known {
	double corner[2][KNOWN_CORNERS][2];  // convex hull of the gazes (horizontal, vertical), anticlockwise: gazes of the clip; they may repeat
	double torsion[2][2];                // least and largest
	double beyond;                       // lids follow further by so much of the hull's half width at most
};

/* All gazes are known: nothing is held. */
void known_all(struct known *known);

/* The gazes of n frames: g[n][stride], of which five are the left eye's and five the right eye's (model.h); NAN: not measured, that frame does
 * not count. An eye of which no frame counts is as the other. */
void known_of(struct known *known, long n, const double *g, int stride, double beyond);

/* The gaze (horizontal, vertical, torsion) that drives the lids of an eye which looks so, in and out: itself where it is known, else
 *
 *     p + r tanh(|g - p| / r) (g - p) / |g - p|,   r = beyond * half the hull's width in that direction
 *
 * of the nearest known p. Torsion likewise. Continuous, and smooth where it leaves the hull. */
void known_hold(double gaze[3], const struct known *known, int eye);

/* Whether what was read from `place` is one: angles within a circle, beyond in 0 .. 10. Else false, err set. */
bool known_check(const struct known *known, const char *place, struct err *err);

#endif
