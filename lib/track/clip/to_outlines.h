/* to_outlines: the lids' margins drawn to where the network's evidence has them (outlines.h). Edges and colours that a clip is followed by tell how a margin moves to a fraction
 * of a pixel, not which line of the lid it is; the evidence was taught that.
 */
#ifndef TRACK_CLIP_TO_OUTLINES_H
#define TRACK_CLIP_TO_OUTLINES_H
#include "track/clip/conf.h"
#include "track/clip/result.h"

/* Draws the margins in result->eyes to the mean of the outlines that are near in time and open as far. Without outlines nothing changes. */
void track_outlines(struct track_result *result, const struct track_conf *conf);

#endif
