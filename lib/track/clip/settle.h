/* settle: chooses the reference frame and refines the head's pose in it, from frames spread over the clip. */
#ifndef TRACK_CLIP_SETTLE_H
#define TRACK_CLIP_SETTLE_H
#include "track/clip/clip.h"

/* Follows a few frames; judges the reference by them (reference.h); takes a better frame, or the head the other way up, where
 * they call for it; refines the pose by the eyeballs' centres and the lids at rest (refine.h); where its residual is beyond
 * conf->pose_most, or its skin off that of most frames, tries frames spread over the clip and keeps the likeliest (trust_reference). Does nothing without a mesh (alone.h),
 * where pose_given, or where conf->settle is 0. What cannot be followed is no error here: the clip is left as it was. Returns false, err set, where
 * the evidence's network cannot be read. */
bool track_settle(struct track_clip *clip, struct stage *stage, const struct track_subject *subject, const struct track_conf *conf, struct err *err);

/* Whether the reference's pose may be built upon. Returns false, err set (frame, residual, rule), where its residual is beyond
 * conf->pose_refused; true without a mesh, where pose_given, or where conf->settle is 0: there is none to judge by. */
bool track_settled(const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf, struct err *err);

#endif
