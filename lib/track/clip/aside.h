/* aside: films that lie on their side, as of a telephone held upright whose file does not say so.
 */
#ifndef TRACK_CLIP_ASIDE_H
#define TRACK_CLIP_ASIDE_H
#include "track/clip/clip.h"

/* Why a clip whose eyes were not found, or not followed, was refused: where the evidence shows a pair of eyes in the reference frame turned by a quarter, and none so
 * clearly in it as it is, err's message is replaced by that. Returns false. */
bool track_lies_aside(const struct track_clip *clip, struct err *err);

#endif
