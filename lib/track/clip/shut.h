/* shut: lids while an eye blinks. */
#ifndef TRACK_CLIP_SHUT_H
#define TRACK_CLIP_SHUT_H
#include "track/clip/track.h"

/* When the upper lid comes down its lashes hide the lower margin, and what is between the two is dark: the margin found there is worth little, and the
 * skin beside it no more. From the frames before and after a blink it goes along with the head: with the n places of the mesh's margin,
 * carried[frame][n], px; NaN where not known. (It gives way by up to half a millimetre towards the nose, too.) */
void shut_carry(struct track_result *result, int side, int n, const double (*carried)[2]);

/* Towards the corners the lashes of an upper lid that comes down lie over its margin: there each place of it is taken to have come as far from where it was
 * before and after the blink to the lower margin as its middle has, unless what is found is nearer to that than near_px. The inner and the outer corner,
 * corner[frame], px, NAN where not known, are meanwhile carried from before and after it as the lower margin is. After shut_carry. */
void fall_carry(struct track_result *result, int side, double (*corner)[2][2], int n, const double (*carried)[2], double near_px);

#endif
