/* frames: frames of a video as views: spread evenly over the change of the picture, the sharpest of each stretch.
 */
#ifndef SFM_FRAMES_H
#define SFM_FRAMES_H
#include "sfm/pictures.h"

/* Selects at most n frames of the first file of video/, writes their pictures and appends them to the views. The selection is kept
 * in work/calibrate/frames.json; frames in `known` are not decoded again.
 * A video that cannot be read is recorded as skipped. Returns false, err set, when a picture cannot be written. */
bool frames_add(struct views *views, int n, const struct pictures *known, struct stage *stage, const struct calibrate_options *o,
                struct err *err);

#endif
