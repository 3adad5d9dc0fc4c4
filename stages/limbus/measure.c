#include "limbus.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/photo/photo.h"
#include "limbus/hand.h"
#include "limbus/measure.h"

char *limbus_record_path(const struct capture_photo *photo)
{
	return mem_printf("work/limbus/%s.edge.json", photo->name);
}

#define RIG "work/rig.json"

/* The ellipse that capture.conf gives for this photograph, if any. False where it cannot be meant: the record says why. */
static bool hand_of(struct ellipse *meant, struct limbus_record *record, const char *name, const struct photo *photo,
                    const struct limbus_options *o)
{
	const struct opt_each *hint = capture_each(&o->photo_hint, name), *drawn = capture_each(&o->photo_limbus, name);
	struct err err = { 0 };
	if (!hint && !drawn)
		return true;
	const double *v = drawn ? drawn->value : hint->value;
	*meant = (struct ellipse){ v[0], v[1], v[2], drawn ? v[3] : v[2], drawn ? v[4] * M_PI / 180 : 0 };
	char *key = mem_printf("photo.%s.%s", name, drawn ? "limbus_px" : "hint_px");
	bool ok = limbus_hand_check(meant, key, photo->width, photo->height, &err);
	free(key);
	record->width = photo->width;
	record->height = photo->height;
	snprintf(record->reason, sizeof record->reason, "%.250s", err.msg);
	return ok;
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
		snprintf(record->reason, sizeof record->reason, "%.250s", err_less(&err, stage_path(stage, "%s", p->file)));
		return;
	}
	const struct opt_each *hint = capture_each(&o->photo_hint, p->name), *focal = capture_each(&o->photo_focal, p->name);
	const struct opt_each *center = capture_each(&o->photo_center, p->name);
	struct limbus_camera known = { &o->camera, focal ? focal->value[0] : NAN, center ? center->value : 0,
		                       camera_rig_find(rig, p->file) };
	struct ellipse meant;
	if (hand_of(&meant, record, p->name, &photo, o))
		limbus_measure_photo(record, &photo, hint ? hint->value : 0, capture_each(&o->photo_limbus, p->name) ? &meant : 0, &known, &o->eye,
		                     &o->find, &o->pose);
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
		// The rig is an input only of photographs that it has a camera for.
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
