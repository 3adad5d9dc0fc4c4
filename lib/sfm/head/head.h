/* head: the reconstruction in the head's frame: mm, x to the person's left, y up, z out of the face.
 * World is the COLMAP model's own frame and unit.
 */
#ifndef SFM_HEAD_HEAD_H
#define SFM_HEAD_HEAD_H
#include "sfm/head/sfm_frame.h"
#include "sfm/views.h"

struct head {
	struct colmap_model *model;  // borrowed
	struct sfm_subject subject;  // world
	struct sfm_frame frame;      // head from world
	double scale_sigma;          // of frame.scale, relative, 1 sd; NAN: assumed
	bool has_eyes;
	double eye_center[2][3];     // of the left and the right eyeball, head, mm
	const char *scale_source, *frame_source;  // in words, for rig.json: "ruler", "eyes and mouth" ...
	double residual_px;          // mean, in the photographs' own pixels
};

/* Fills everything of head but model and residual_px.
 * Scale: the first source that gives one: ruler, markers, measured distances, the limbus, the eyes' distance, else an assumed head.
 * Frame: from eyes and mouth, named in capture.conf or found; else from the cameras.
 * Returns false, err set, when capture.conf's points cannot be used or the cameras all look the same way. */
bool head_place(struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                struct err *err);

/* The registered image of a view, within head->model; null: it is not registered. */
const struct colmap_image *head_image(const struct head *head, const struct view *view);

/* Fills the rig: cameras in px of the photographs, poses in the head's frame; and head->residual_px. Writes it to path, with what was
 * not registered and why. camera_rig_free in any case. Returns false, err set, when the file cannot be written. */
bool rig_out(struct camera_rig *rig, struct head *head, const struct views *views, const char *path, const char *made_by,
             struct err *err);

#endif
