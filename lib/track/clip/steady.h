/* steady: the head's path over a whole clip, smoothed so that facial expression is not taken for head motion. */
#ifndef TRACK_CLIP_STEADY_H
#define TRACK_CLIP_STEADY_H
#include "track/clip/points.h"
#include "track/clip/result.h"

/* After the last frame: decides whether the head is on a rest (then every pose is the reference's), else smooths its path. Of
 * one that turns (moves.h) frames whose skin is more than stirs_mm off the rigid head are unsure_at. Sets misfit, rests, unsure, unsure_at, pose and
 * skin_model. reference: index of the reference among the frames followed. */
void track_steady(struct track_result *result, long reference, const struct track_points *points, const struct track_subject *subject,
                  const struct track_clip *clip, double stirs_mm);

#endif
