#ifndef SFM_FIGURE_FIGURE_H
#define SFM_FIGURE_FIGURE_H
#include "optics/camera_rig.h"
#include "sfm/head/head.h"

#define FIGURE CALIBRATE_DIR "/rig.png"

/* For people to look at: cameras and points from two sides, each camera coloured by its residual, a bar of residual for
 * every picture, and the mesh from the front and the side where there is one. */
bool figure_draw(const struct head *head, const struct camera_rig *rig, struct stage *stage, struct err *err);

#endif
