#include "limbus/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/face/face.h"
#include "optics/sensor.h"

/* The camera from the first source that gives a focal length: struct limbus_camera. */
static struct camera camera_of(const struct limbus_camera *known, const struct photo *photo, const struct ellipse *limbus,
                               const struct eye *eye)
{
	struct camera c = pose_nominal_camera(limbus, eye, photo->width, photo->height);
	const struct rig_camera *calibrated = known->calibrated;
	const double longer = fmax(photo->width, photo->height);
	const struct photo_exif *exif = &photo->exif;
	double by_keys = camera_keys_focal(known->keys, photo->width, photo->height), by_exif = exif->focal_px;
	if (!isfinite(by_exif))
		by_exif = sensor_focal_px(exif->model, exif->focal_mm, (int)longer);
	if (isfinite(known->focal_px) || isfinite(by_keys)) {
		c.focal_px = isfinite(known->focal_px) ? known->focal_px : by_keys;
		c.source = CAMERA_CONF;
	} else if (calibrated && calibrated->width == photo->width && calibrated->height == photo->height) {
		return calibrated->camera;
	} else if (isfinite(by_exif)) {
		/* EXIF states the focal length at infinity: close up the picture lies (1 + magnification) times as far behind
		 * the lens. */
		double m = isfinite(exif->focal_mm) ? limbus->a / eye->limbus_radius * exif->focal_mm / by_exif : 0;
		c.focal_px = by_exif * (1 + m);
		c.source = CAMERA_EXIF;
	} else {
		return c;
	}
	for (int i = 0; i < 2; i++)
		if (known->center_px || isfinite(known->keys->center_px[i]))
			c.center_px[i] = known->center_px ? known->center_px[i] : known->keys->center_px[i];
	memcpy(c.distortion, known->keys->distortion, sizeof c.distortion);
	return c;
}

/* Fills the record's lean: the log likelihood ratio of the two trial poses by the brightness of the iris. */
static bool lean(struct limbus_record *record, const struct limbus_found *found, const struct eye *eye,
                 const struct pose_conf *pose_conf, struct err *err)
{
	struct pose_view *view = &record->view;
	struct pose_conf conf = *pose_conf;
	struct pose pose;
	if (isfinite(eye->limbus_aspect)) {
		conf.aspect_mean = eye->limbus_aspect;
		conf.aspect_sigma = 0;
	}
	if (!limbus_pose(&pose, view, eye, &conf, err))
		return false;
	if (isfinite(pose.margin)) {
		double sum = lean_iris(&found->band, &view->camera, pose.cam_from_eye, pose.other_cam_from_eye, eye);
		view->lean[0] = sum * cos(pose.phi);
		view->lean[1] = sum * sin(pose.phi);
	}
	return true;
}

static void record_of(struct limbus_record *record, const struct limbus_found *found, const struct photo *photo, const struct limbus_camera *known,
                      const struct eye *eye, const struct pose_conf *pose_conf)
{
	struct err err = { 0 };
	limbus_record_fill(record, found, photo);
	if (!limbus_usable(found))
		return;
	record->view.camera = camera_of(known, photo, &record->view.limbus, eye);
	const struct camera *camera = &record->view.camera;
	const bool ok = (isfinite(known->focal_px) || camera_keys_agree(known->keys, photo->width, photo->height, &err))
	                && (camera->source != CAMERA_CONF || camera_keys_place(camera->focal_px, eye->limbus_radius, record->view.limbus.a, &err))
	                && camera_keys_check(camera, photo->width, photo->height, &err) && lean(record, found, eye, pose_conf, &err);
	if (!ok) {
		record->ok = false;
		record->rough = 0;
		snprintf(record->reason, sizeof record->reason, "%.250s", err.msg);
	}
}

void limbus_measure_photo(struct limbus_record *record, const struct photo *photo, const double *hint, const struct ellipse *drawn,
                          const struct limbus_camera *known, const struct eye *eye, const struct limbus_conf *conf,
                          const struct pose_conf *pose_conf)
{
	struct limbus_found *found = mem_new(1, sizeof *found);
	if (drawn)
		limbus_find_drawn(found, photo, drawn, conf);
	else
		limbus_find(found, photo, hint, conf);
	record_of(record, found, photo, known, eye, pose_conf);
	free(found);
}

/* An eye that a person marks, in place of what was found of it. */
static void by_hand(struct limbus_found *found, const struct photo *photo, const struct limbus_mark *mark, const struct limbus_conf *conf)
{
	if (mark->drawn)
		limbus_find_drawn(found, photo, mark->drawn, conf);
	else
		limbus_find(found, photo, mark->hint, conf);
}

/* Of a photograph in which one eye was found: that one is the unmarked eye, unless it is the marked one. */
static void other_than(struct limbus_found found[2], int marked)
{
	const struct ellipse *e = &found[1 - marked].limbus.e, *f = &found[marked].limbus.e;
	if (e->a > 0 && hypot(e->cx - f->cx, e->cy - f->cy) > f->a)
		return;
	found[1 - marked] = (struct limbus_found){ .posterior = { .best = -1, .rival = -1, .gross = 1 } };
	snprintf(found[1 - marked].reason, sizeof found[1 - marked].reason, "the other eye was not found: open it wide, or say where it is with photo.NAME.%s.hint_px",
	         marked == FACE_LEFT ? "right" : "left");
}

int limbus_measure_face(struct limbus_record record[2], const struct photo *photo, const struct limbus_mark mark[2], bool mirrored,
                        const struct limbus_camera *known, const struct eye *eye, const struct limbus_conf *conf, const struct pose_conf *pose_conf)
{
	struct limbus_found *found = mem_new(2, sizeof *found);
	const bool marked[2] = { mark[0].hint || mark[0].drawn, mark[1].hint || mark[1].drawn };
	int n = marked[0] && marked[1] ? 2 : limbus_find_face(found, photo, mirrored, conf);
	if (n == 1 && (marked[0] || marked[1]))
		found[1] = found[0];
	for (int s = 0; s < 2; s++)
		if (marked[s])
			by_hand(&found[s], photo, &mark[s], conf);
	for (int s = 0; s < 2 && n == 1; s++)
		if (marked[s])
			other_than(found, s);
	n = marked[0] || marked[1] ? 2 : n;
	for (int s = 0; s < n; s++)
		record_of(&record[s], &found[s], photo, known, eye, pose_conf);
	free(found);
	return n;
}
