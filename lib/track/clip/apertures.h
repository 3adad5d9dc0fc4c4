/* apertures: how far each lid stands from where the lids meet: g4, g5, g9, g10 of the skin paper (section 3.3). */
#ifndef TRACK_CLIP_APERTURES_H
#define TRACK_CLIP_APERTURES_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Allocates and fills result's lids, lids_model, g but for expressions (track_expressions), and aperture_sigma; NAN where not measured. */
void track_apertures(struct track_result *result, const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf);

#endif
