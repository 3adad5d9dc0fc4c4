/* colour: Fisher's linear discriminant of sclera and iris colours. */
#ifndef LIMBUS_PROPOSE_COLOUR_H
#define LIMBUS_PROPOSE_COLOUR_H
#include "limbus/image.h"

/* The weights of the linear channels that separate a band inside and a band outside the ellipse best against their own texture,
 * from the half of the ring that is whitest outside (away from lids); scaled so that the step is 1. Streaks of an iris differ in
 * brightness more than in hue: the discriminant removes them and keeps the ramp, whose opacity mixes linearly in every channel.
 * weight: out; may be negative. Returns how many times as far it separates them as brightness alone does, at the quarter of these places where
 * either is poor; INFINITY where brightness does not. */
double limbus_colour(double weight[3], const struct photo *photo, const struct ellipse *e);

#endif
