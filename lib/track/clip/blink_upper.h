/* blink_upper: the upper lid's margin during blinks, on its way down and up. */
#ifndef TRACK_CLIP_BLINK_UPPER_H
#define TRACK_CLIP_BLINK_UPPER_H
#include "track/clip/result.h"

/* Near the corners the lashes of a lid that comes down hide its margin. There each place of the margin is set to the same
 * closure (share of the way from its place before and after the blink to the lower margin) as the middle of the lid has, unless
 * the margin found lies within about near_px of that. After blink_lower_carry.
 * corner: [frame][inner, outer] px, NAN where not known; in blinks replaced by interpolation between the frames before and
 * after.
 * carried: [frame][n] px as in blink_lower_carry. */
void blink_upper_carry(struct track_result *result, int side, double (*corner)[2][2], int n, const double (*carried)[2], double near_px);

#endif
