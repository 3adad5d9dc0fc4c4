/* agree: whether both eyes of a clip could be followed as one person's. */
#ifndef TRACK_CLIP_AGREE_H
#define TRACK_CLIP_AGREE_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Gaze in conf->gaze_least of the frames in the better eye, and both looking equally high, to conf->agree_deg in the median, and
 * not further apart than conf->diverge_deg; and skin that moves with the rigid head, to conf->misfit_mm in the median over frames of the median over the
 * points: a head that turns while the pose does not follow it is off by centimetres.
 * clip: names the file. Returns false, err set (share or angle, rule), where not. */
bool track_agrees(const struct track_result *result, const struct track_clip *clip, const struct track_conf *conf, struct err *err);

#endif
