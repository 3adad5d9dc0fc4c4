#include "stages/calibrate/head.h"

#include <math.h>

#include "stages/calibrate/places.h"

/* Eyeballs behind the irises: a sphere of 12 mm cut by the limbus's plane, the eyes looking ahead. */
static void place_eyes(struct head *head, const double left[3], const double right[3], double limbus_mm)
{
	const double globe_mm = 12;
	sfm_to_head(head->eye_center[0], &head->frame, left);
	sfm_to_head(head->eye_center[1], &head->frame, right);
	for (int e = 0; e < 2; e++)
		head->eye_center[e][2] -= sqrt(globe_mm * globe_mm - limbus_mm * limbus_mm);
	head->has_eyes = true;
}

/* The first source that says anything: rulers and markers are exact, a tape less, people's eyes least. */
static bool find_scale(double *scale, struct head *head, const struct views *views, struct stage *stage,
                       const struct calibrate_options *o, struct err *err)
{
	struct places_lengths lengths = { 0 };
	double common = 0;
	head->scale_source = "ruler";
	bool ok = places_ruler(&lengths, head, views, o, err);
	if (ok && !lengths.n) {
		head->scale_source = "marker";
		ok = places_markers(&lengths, head, stage, o, err);
	}
	if (ok && !lengths.n) {
		head->scale_source = "distance";
		ok = places_distances(&lengths, head, views, o, err);
	}
	if (ok && !lengths.n) {
		head->scale_source = "limbus";
		ok = places_limbus(&lengths, &common, head, views, stage, o, err);
	}
	if (!ok || lengths.n) {
		*scale = ok ? sfm_scale(&head->scale_sigma, lengths.n, lengths.l) : 1;
		head->scale_sigma = hypot(head->scale_sigma, common);
		return ok;
	}
	head->scale_source = "assumed";
	head->scale_sigma = NAN;
	*scale = o->head_radius_mm / head->subject.radius * SFM_SUBJECT_REACH;
	stage_skipped(stage, "scale: nothing of known length in the views: the head is taken to be %.0f mm tall. Lay a printed marker "
	              "beside it (calibrate.marker_mm), or name the eyes in two views (view.NAME.left_eye_px)", 2 * o->head_radius_mm);
	return true;
}

bool head_place(struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                struct err *err)
{
	double scale, left[3], right[3], mouth[2][3], middle[3];
	bool has_left, has_right, has_mouth, has_other;
	if (!sfm_subject(&head->subject, head->model, err))
		return err_wrap(err, "%s/views", stage->capture);
	if (!find_scale(&scale, head, views, stage, o, err)
	    || !places_point(left, &has_left, head, views, &o->left_eye, 0, err)
	    || !places_point(right, &has_right, head, views, &o->right_eye, 0, err)
	    || !places_point(mouth[0], &has_mouth, head, views, &o->mouth, 0, err)
	    || !places_point(mouth[1], &has_other, head, views, &o->mouth, 2, err))
		return false;
	for (int i = 0; i < 3; i++)
		middle[i] = 0.5 * (mouth[0][i] + mouth[1][i]);
	bool eyes = has_left && has_right;
	head->frame_source = !eyes ? "cameras" : has_mouth ? "eyes and mouth" : "eyes";
	if (eyes) {
		sfm_frame_eyes(&head->frame, head->model, left, right, has_mouth ? middle : 0, scale);
		place_eyes(head, left, right, o->limbus_radius_mm);
	} else
		sfm_frame_cameras(&head->frame, head->model, &head->subject, scale);
	return true;
}
