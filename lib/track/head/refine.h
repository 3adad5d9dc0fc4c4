/* refine: head pose refined by the outlines of the eyes' openings in the picture.
 * Head frame  the subject mesh's axes, mm.  Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_HEAD_REFINE_H
#define TRACK_HEAD_REFINE_H
#include "track/head/find.h"

/* Refines found->cam_from_head, which must be roughly right, and sets seen and edge_px. rgb[height][3 width]; opening[2]: left,
 * right; camera->focal_px must be known. Returns false when no outline is found. */
bool head_find_refine(struct head_found *found, const uint8_t *rgb, int width, int height, const struct camera *camera,
                      const struct eye_opening opening[2], const struct head_find_conf *conf);

/* px for a px of a picture 1280 wide in which an opening is 253 px wide: of this picture, or where its eyes are smaller, as theirs are. */
double head_find_scale(int width, const struct camera *camera, const double cam_from_head[4][4], const struct eye_opening opening[2]);

#endif
