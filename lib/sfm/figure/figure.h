/* figure: work/calibrate/rig.png, the reconstruction for people to look at.
 */
#ifndef SFM_FIGURE_FIGURE_H
#define SFM_FIGURE_FIGURE_H
#include "optics/camera_rig.h"
#include "sfm/head/head.h"

#define FIGURE CALIBRATE_DIR "/rig.png"

/* Draws cameras and points from two sides, each camera coloured by its residual, a bar of residual for every picture, and the mesh
 * from the front and the side where there is one. Returns false, err set, when the file cannot be written. */
bool figure_draw(const struct head *head, const struct camera_rig *rig, struct stage *stage, struct err *err);

#endif
