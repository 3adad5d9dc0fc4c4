/* together: skin that moves about the head moves as its neighbours do. Of a head that turns, patches slide on shaded skin, each its own way; what
 * is left when the rigid head's motion is taken away is smooth.
 */
#ifndef TRACK_CLIP_TOGETHER_H
#define TRACK_CLIP_TOGETHER_H
#include "track/clip/points.h"
#include "track/clip/result.h"

/* After the head's path is known: moves every point towards where the rigid head and the mean motion of its neighbours about it (Tukey's weights)
 * put it, the more the more these scatter (Wiener's shrinkage, conf->own_mm), and lowers the confidence of one that lies off, to 0 beyond twice
 * conf->astray_mm. Off the lids that motion counts as far as it is more than the neighbours scatter; a point most of whose neighbours are not seen is not either.
 * Sets skin, skin_model, confidence. */
void track_together(struct track_result *result, const struct track_points *points, const struct track_clip *clip, const struct track_subject *subject,
                    const struct track_conf *conf);

#endif
