#include "limbus.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/photo/photo.h"
#include "optics/camera_rig.h"
#include "optics/sensor.h"

char *limbus_record_path(const struct capture_photo *photo)
{
	return mem_printf("work/limbus/%s.edge.json", photo->name);
}

#define RIG "work/rig.json"

/* The camera `calibrate` found for this photograph, when it is of the size it was found at; else null. */
static const struct rig_camera *rig_camera_of(const struct camera_rig *rig, const char *file, const struct photo *photo)
{
	const struct rig_camera *c = camera_rig_find(rig, file);
	return c && c->width == photo->width && c->height == photo->height ? c : 0;
}

/* capture.conf for this photograph, for all, what calibrate found, EXIF with the table of sensors, in that order; none: a nominal camera far away. */
static struct camera camera_of(const struct limbus_options *o, const char *name, const struct photo *photo,
                               const struct ellipse *limbus, const struct rig_camera *calibrated)
{
	struct camera c = pose_nominal_camera(limbus, &o->eye, photo->width, photo->height);
	const struct opt_each *focal = capture_each(&o->photo_focal, name), *center = capture_each(&o->photo_center, name);
	const double longer = fmax(photo->width, photo->height);
	const struct photo_exif *exif = &photo->exif;
	double by_keys = camera_keys_focal(&o->camera, photo->width, photo->height), by_exif = exif->focal_px;
	if (!isfinite(by_exif))
		by_exif = sensor_focal_px(exif->model, exif->focal_mm, (int)longer);
	if (focal)
		c.focal_px = focal->value[0];
	else if (isfinite(by_keys))
		c.focal_px = by_keys;
	if (focal || isfinite(by_keys)) {
		c.source = CAMERA_CONF;
	} else if (calibrated) {
		return calibrated->camera;
	} else if (isfinite(by_exif)) {
		/* EXIF names the focal length at infinity: close up the picture lies (1 + magnification) times as far behind
		 * the lens. */
		double m = isfinite(exif->focal_mm) ? limbus->a / o->eye.limbus_radius * exif->focal_mm / by_exif : 0;
		c.focal_px = by_exif * (1 + m);
		c.source = CAMERA_EXIF;
	} else {
		return c;
	}
	for (int i = 0; i < 2; i++)
		if (center || isfinite(o->camera.center_px[i]))
			c.center_px[i] = center ? center->value[i] : o->camera.center_px[i];
	memcpy(c.distortion, o->camera.distortion, sizeof c.distortion);
	return c;
}

/* Camera, then which way the eye leans, from two trial poses. */
static bool lean(struct limbus_record *record, const struct limbus_found *found, const struct photo *photo,
                 const char *name, const struct limbus_options *o, const struct rig_camera *calibrated, struct err *err)
{
	struct pose_view *view = &record->view;
	struct pose_conf conf = o->pose;
	struct pose pose;
	view->camera = camera_of(o, name, photo, &view->limbus, calibrated);
	if (isfinite(o->eye.limbus_aspect)) {
		conf.aspect_mean = o->eye.limbus_aspect;
		conf.aspect_sigma = 0;
	}
	if (!limbus_pose(&pose, view, &o->eye, &conf, err))
		return false;
	if (isfinite(pose.margin)) {
		double sum = lean_iris(&found->band, &view->camera, pose.cam_from_eye, pose.other_cam_from_eye, &o->eye);
		view->lean[0] = sum * cos(pose.phi);
		view->lean[1] = sum * sin(pose.phi);
	}
	return true;
}

static void measure_one(struct limbus_record *record, struct limbus_kept *kept, struct stage *stage, const struct capture_photo *p,
                        const struct limbus_options *o, const struct camera_rig *rig)
{
	struct photo photo = { 0 };
	struct err err = { 0 };
	photo_free(&kept->photo);
	*kept = (struct limbus_kept){ 0 };
	*record = (struct limbus_record){ 0 };
	if (!photo_load(&photo, stage_path(stage, "%s", p->file), o->limit_mpx, &err)) {
		record->width = record->height = 1;
		const char *msg = err.msg, *prefix = stage_path(stage, "%s", p->file);
		if (!strncmp(msg, prefix, strlen(prefix)))
			msg += strlen(prefix) + (msg[strlen(prefix)] == ':' ? 1 : 0);
		snprintf(record->reason, sizeof record->reason, "%.250s", msg + strspn(msg, " "));
		return;
	}
	struct limbus_found *found = mem_new(1, sizeof *found);
	const struct opt_each *hint = capture_each(&o->photo_hint, p->name);
	limbus_find(found, &photo, hint ? hint->value : 0, &o->find);
	limbus_record_fill(record, found, &photo);
	if (record->ok && !lean(record, found, &photo, p->name, o, rig_camera_of(rig, p->file, &photo), &err)) {
		record->ok = false;
		snprintf(record->reason, sizeof record->reason, "%.250s", err.msg);
	}
	free(found);
	*kept = (struct limbus_kept){ p, photo };
}

bool limbus_measure(struct limbus_kept *kept, struct stage *stage, const struct capture *capture, const struct limbus_options *o,
                    struct err *err)
{
	struct camera_rig rig = { 0 };
	const char *path = stage_path(stage, RIG);
	const bool has_rig = file_exists(path);
	bool ok = !has_rig || camera_rig_load(&rig, path, err);
	for (int i = 0; i < capture->n_photos && ok; i++) {
		const struct capture_photo *p = &capture->photos[i];
		// A photograph the rig does not know is measured the same with and without it.
		const int n_in = camera_rig_find(&rig, p->file) ? 2 : 1;
		const char *in[] = { p->file, RIG };
		char *out = limbus_record_path(p);
		stage_progress(stage, i, capture->n_photos, "measure");
		if (!stage_fresh(stage, out, n_in, in)) {
			struct limbus_record *record = mem_new(1, sizeof *record);
			measure_one(record, kept, stage, p, o, &rig);
			ok = limbus_record_save(record, stage_path(stage, "%s", out), stage_made_by(stage, n_in, in), err)
			     && stage_made(stage, out, n_in, in, err);
			free(record);
		}
		free(out);
	}
	camera_rig_free(&rig);
	return ok;
}
