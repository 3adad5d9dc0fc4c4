/* follow: the pipeline of a clip: every frame is decoded, its skin tracked, its head pose and eyes estimated. */
#ifndef TRACK_CLIP_FOLLOW_H
#define TRACK_CLIP_FOLLOW_H
#include "track/clip/points.h"
#include "track/clip/result.h"

/* Follows clip->file from its start, one frame in conf->every, at most conf->limit (0: all of them). Fills result but for lids,
 * lids_model and g; track_result_free in any case. conf->limit 0 also keeps frames for film.h and folds.h and shows progress.
 * Returns false, err set, when the video cannot be read or no eye is found. */
bool track_follow(struct track_result *result, struct stage *stage, const struct track_clip *clip,
                  const struct track_subject *subject, const struct track_points *points, const struct track_conf *conf,
                  struct err *err);

#endif
