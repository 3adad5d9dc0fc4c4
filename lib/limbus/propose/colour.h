/* limbus_colour: the mixture of the three channels in which sclera and iris differ most against their own texture. */
#ifndef LIMBUS_PROPOSE_COLOUR_H
#define LIMBUS_PROPOSE_COLOUR_H
#include "limbus/image.h"

/* Fisher's discriminant of linear colour between a band inside and a band outside the ellipse, from the half of the
 * ring that is whitest outside (lids are elsewhere); scaled so that the step is 1. An iris' streaks differ in
 * brightness more than in hue: the mixture that removes them leaves the ramp, whose opacity mixes linearly in every
 * channel. weight may be negative. */
void limbus_colour(double weight[3], const struct photo *photo, const struct ellipse *e);

#endif
