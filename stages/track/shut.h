/* shut: lower lids while an eye blinks. */
#ifndef TRACK_SHUT_H
#define TRACK_SHUT_H
#include "stages/track/track.h"

/* When the upper lid comes down its lashes hide the lower margin, and what is between the two is dark: the margin found there is worth little, and the
 * skin beside it no more. From the frames before and after a blink it goes along with the head: with the n places of the mesh's margin,
 * carried[frame][n], px; NaN where not known. (It gives way by up to half a millimetre towards the nose, too.) */
void shut_carry(struct track_result *result, int side, int n, const double (*carried)[2]);

#endif
