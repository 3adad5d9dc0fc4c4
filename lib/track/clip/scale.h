/* scale: how large a millimetre about the eyes is in the picture. */
#ifndef TRACK_CLIP_SCALE_H
#define TRACK_CLIP_SCALE_H
#include "track/clip/clip.h"

/* Pixels that a millimetre of skin has about the eyes, under a pose of the head (track_eyes_depth). */
double track_px_per_mm(const struct track_clip *clip, const double cam_from_head[4][4], const struct track_subject *subject);

#endif
