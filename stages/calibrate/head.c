#include "stages/calibrate/head.h"

#include <math.h>

bool head_place(struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                struct err *err)
{
	(void)views;
	if (!sfm_subject(&head->subject, head->model, err))
		return err_wrap(err, "%s/views", stage->capture);
	head->scale_sigma = NAN;
	head->scale_source = "assumed";
	head->frame_source = "cameras";
	sfm_frame_cameras(&head->frame, head->model, &head->subject, o->head_radius_mm / head->subject.radius);
	stage_skipped(stage, "scale: nothing in the views has a known length: the head is taken to be %.0f mm tall", 2 * o->head_radius_mm);
	return true;
}
