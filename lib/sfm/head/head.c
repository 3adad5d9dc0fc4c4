#include "sfm/head/head.h"

#include <math.h>

#include "sfm/head/eyes.h"
#include "sfm/head/limbus_scale.h"

/* Standard deviation among adults (Dodgson 2004). */
static const double eyes_apart_sigma_mm = 3.8;

/* Places the eyeballs behind the irises: spheres of 12 mm radius, cut by the plane of the limbus, the eyes looking ahead. */
static void place_eyes(struct head *head, const double left[3], const double right[3], double limbus_mm)
{
	const double globe_mm = 12;
	sfm_to_head(head->eye_center[0], &head->frame, left);
	sfm_to_head(head->eye_center[1], &head->frame, right);
	for (int e = 0; e < 2; e++)
		head->eye_center[e][2] -= sqrt(globe_mm * globe_mm - limbus_mm * limbus_mm);
	head->has_eyes = true;
}

/* The scale from the first source that gives one, the most exact first: ruler, markers, tape, iris, eyes' distance. */
static bool find_scale(double *scale, struct head *head, const struct views *views, const struct places_face *face,
                       const struct eyes *eyes, struct stage *stage, const struct calibrate_options *o, struct err *err)
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
		ok = places_limbus(&lengths, &common, head, views, face, stage, o, err);
	}
	if (ok && face->found && lengths.n < 2) {
		// A single iris may be a false detection. The eyes' distance varies more among people, but is seen in every view.
		head->scale_source = "eyes";
		lengths = (struct places_lengths){ .n = 1, .l = { { eyes->apart, o->eyes_apart_mm, fmax(0.01, eyes->sigma) } } };
		common = eyes_apart_sigma_mm / o->eyes_apart_mm;
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

/* Triangulates the points of the face and derives the frame from them. */
static bool place(struct head *head, const struct views *views, const struct places_face *face, double scale,
                  const struct calibrate_options *o, struct err *err)
{
	double eye[2][3], mouth[2][3], middle[3];
	bool has[2], has_mouth, has_other;
	if (!places_point(eye[0], &has[0], head, views, face->eye[0], 0, err) || !places_point(eye[1], &has[1], head, views, face->eye[1], 0, err)
	    || !places_point(mouth[0], &has_mouth, head, views, face->mouth, 0, err)
	    || !places_point(mouth[1], &has_other, head, views, face->mouth, 2, err))
		return false;
	for (int i = 0; i < 3; i++)
		middle[i] = 0.5 * (mouth[0][i] + mouth[1][i]);
	bool eyes = has[0] && has[1];
	// A mouth that is only estimated below the eyes gives the direction of down, not the tilt of the face.
	head->frame_source = !eyes ? "cameras" : has_mouth && face->has_mouth ? "eyes and mouth" : "eyes";
	if (eyes) {
		sfm_frame_eyes(&head->frame, head->model, eye[0], eye[1], has_mouth ? middle : 0, scale);
		place_eyes(head, eye[0], eye[1], o->limbus_radius_mm);
	} else
		sfm_frame_cameras(&head->frame, head->model, &head->subject, scale);
	return true;
}

bool head_place(struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                struct err *err)
{
	double scale;
	struct eyes eyes = { .apart = 0 };
	struct places_face face = { { &o->left_eye, &o->right_eye }, &o->mouth, false, true };
	if (!sfm_subject(&head->subject, head->model, err))
		return err_wrap(err, "%s/views", stage->capture);
	if (o->find_eyes && !o->left_eye.n && !o->right_eye.n) {
		if (!eyes_find(&eyes, head, views, stage, o, err))
			return false;
		if (eyes.apart > 0)
			face = (struct places_face){ { &eyes.side[0], &eyes.side[1] }, o->mouth.n ? &o->mouth : &eyes.mouth, true, o->mouth.n || eyes.mouth_found };
	}
	bool ok = find_scale(&scale, head, views, &face, &eyes, stage, o, err) && place(head, views, &face, scale, o, err);
	eyes_free(&eyes);
	return ok;
}
