/* blink_lower: the lower lid's margin during blinks. */
#ifndef TRACK_CLIP_BLINK_LOWER_H
#define TRACK_CLIP_BLINK_LOWER_H
#include "track/clip/result.h"

/* During a blink the upper lid's lashes hide the lower margin and darken what is left of it, so that neither the margin found
 * there nor the skin beside it can be relied on. Replaces it, from the frames before and after each blink, by what moves
 * rigidly with the head.
 * carried: [frame][n] px, the n places of the mesh's lower margin projected into each frame; NAN where not known. (In truth the
 * lower lid moves by up to half a millimetre towards the nose.) */
void blink_lower_carry(struct track_result *result, int side, int n, const double (*carried)[2]);

#endif
