/* agree: whether what was followed in a clip may be used. */
#ifndef TRACK_CLIP_AGREE_H
#define TRACK_CLIP_AGREE_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Fills result->trust (trust.h). Returns false, err set (what speaks most against it, rule), where the result is wrong with a probability beyond
 * conf->wrong_most, or gaze is known in less than conf->gaze_least of the frames in the better eye. */
bool track_agrees(struct track_result *result, const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf, struct err *err);

#endif
