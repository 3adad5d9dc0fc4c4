/* head: the reconstruction in the head's frame and in millimetres. */
#ifndef SFM_HEAD_HEAD_H
#define SFM_HEAD_HEAD_H
#include "sfm/head/sfm_frame.h"
#include "sfm/views.h"

struct head {
	struct colmap_model *model;
	struct sfm_subject subject;
	struct sfm_frame frame;
	double scale_sigma;          // relative; NAN: assumed
	bool has_eyes;
	double eye_center[2][3];     // of the left and the right eyeball, head, mm
	const char *scale_source, *frame_source;
	double residual_px;          // mean, in the photographs' own pixels
};

/* Scale and frame, by the best that there is. */
bool head_place(struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                struct err *err);

/* The registered image of a view; null: it is not. */
const struct colmap_image *head_image(const struct head *head, const struct view *view);

/* Fills the rig and writes it. camera_rig_free. */
bool rig_out(struct camera_rig *rig, struct head *head, const struct views *views, const char *path, const char *made_by,
             struct err *err);

#endif
