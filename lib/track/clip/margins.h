/* margins: lids over the clip, drawn to where the network's evidence has the openings in every few frames. What follows them from frame to frame (colours, strips, skin
 * beside them) errs for long stretches in the same way, where reddened or shaded white looks like lid and a wet margin like eye; the evidence errs otherwise.
 */
#ifndef TRACK_CLIP_MARGINS_H
#define TRACK_CLIP_MARGINS_H
#include "track/clip/margin_seen.h"

/* After track_corners. Of faces with a mesh and irises no larger than conf's lids.most_px; nothing is done where its lids.every is 0. */
bool track_margins(struct track_result *result, struct stage *stage, const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf,
                   struct err *err);

#endif
