/* corners: the lid margins near the corners of the eye. There the picture shows little contrast: white sclera passes into the
 * wet red of the caruncle. The mesh gives a corner's shape, the skin beside it gives its motion. */
#ifndef TRACK_CLIP_CORNERS_H
#define TRACK_CLIP_CORNERS_H
#include "track/clip/points.h"
#include "track/clip/result.h"

/* Corrects the margins in result->eyes, those of blinks included. Without points, mesh margins or eyes nothing changes. */
void track_corners(struct track_result *result, const struct track_clip *clip, const struct track_subject *subject,
                   const struct track_points *points);

#endif
