/* frames: a video as photographs: the frames that say most, spread over what the camera saw, the sharpest of each stretch. */
#ifndef SFM_FRAMES_H
#define SFM_FRAMES_H
#include "sfm/pictures.h"

/* Appends frames of the first file of video/ to the views, n at most, named and with their pictures written; those that
 * pictures.json knows are not decoded again. A video that cannot be read is said and passed over. False, err set, when a
 * picture cannot be written. */
bool frames_add(struct views *views, int n, const struct pictures *known, struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
