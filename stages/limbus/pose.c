#include "limbus.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/picture.h"
#include "limbus/joint.h"
#include "limbus/overlay.h"

static const double DEG = M_PI / 180;

/* The photographs of one eye. */
struct eye_work {
	struct stage *stage;
	const struct capture *capture;
	const struct limbus_options *o;
	int n;                               // of this eye
	const struct capture_photo **photo;  // [n]
	struct limbus_record *record;        // [n]
	char **path;                         // [n], of the records
	const struct eye_work *all;          // of the capture's eyes
	struct limbus_joint joint;
	int usable;
	struct limbus_kept *kept;
};

/* Four numbers of people's ellipses and an angle in degrees, as limbus/NAME.json has them. */
static json_t *ellipse_of(const struct ellipse *e)
{
	return json_numbers(5, (double[]){ e->cx, e->cy, e->a, e->b, e->angle / DEG });
}

/* How sure the choice is, whether it was refused or not. */
static json_t *doubt_of(const struct limbus_record *r)
{
	json_t *json = json_object();
	json_object_set_new(json, "gross_probability", json_number(r->gross));
	if (!r->ok && r->has_guess)
		json_object_set_new(json, "likeliest_px", ellipse_of(&r->guess));
	if (r->has_rival)
		json_object_set_new(json, "rival_px", ellipse_of(&r->rival));
	return json;
}

/* Keys of a refused photograph's; free(). */
static char *refused_of(const struct limbus_record *r)
{
	json_t *json = doubt_of(r);
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(12));
	json_decref(json);
	return text;
}

/* Keys of limbus/NAME.json beyond those of lib/README.md, as JSON text; free(). */
static char *extra_of(const struct limbus_record *r, const struct pose *pose)
{
	json_t *json = doubt_of(r);
	json_object_set_new(json, "theta_weak_perspective_deg", json_number(pose->theta_weak / DEG));
	json_object_set_new(json, "by_hand", json_boolean(r->by_hand));
	json_object_set_new(json, "choice_margin", json_number(pose->margin));
	json_t *other = json_object();
	json_object_set_new(other, "theta_deg", json_number(pose->other_theta / DEG));
	json_object_set_new(other, "phi_deg", json_number(pose->other_phi / DEG));
	json_object_set_new(json, "other_pose", other);
	json_object_set_new(json, "pupil_offset_mm", json_numbers(2, pose->pupil_offset));
	json_object_set_new(json, "contrast", json_number(r->contrast));
	json_object_set_new(json, "share_used", json_number(r->share_used));
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(12));
	json_decref(json);
	return text;
}

static bool write_overlay(const struct eye_work *w, int i, const struct fit *fit, const char *path, struct err *err)
{
	struct limbus_kept *kept = w->kept;
	const struct capture_photo *p = w->photo[i];
	if (!limbus_keep(kept, p->file, stage_path(w->stage, "%s", p->file), w->o->limit_mpx, err))
		return false;
	int width, height;
	uint8_t *px = limbus_overlay(&width, &height, w->o->overlay_px, &kept->photo, &w->record[i], fit);
	bool ok = picture_png_write(stage_path(w->stage, "%s", path), px, width, height, 3, err);
	free(px);
	return ok;
}

static void note(const struct eye_work *w, int i, const struct fit *fit, const struct pose *pose)
{
	const char *name = w->photo[i]->name;
	stage_note(w->stage, "%s: theta %.1f +- %.1f deg, %.0f %% of the limbus seen, rms %.2f px%s%s", name, fit->theta / DEG,
	           fit->theta_sigma / DEG, 100 * fit->coverage, fit->rms_px,
	           fit->camera.source == CAMERA_NONE ? ", camera unknown: weak perspective" : "",
	           w->record[i].by_hand ? ", where capture.conf says: by hand" : fit->rough > 0 ? ", roughly" : "");
	char key[320];
	snprintf(key, sizeof key, "%s rms", name);
	stage_figure(w->stage, key, fit->rms_px, "px");
	snprintf(key, sizeof key, "%s theta", name);
	stage_figure(w->stage, key, fit->theta / DEG, "deg");
	snprintf(key, sizeof key, "%s theta sigma", name);
	stage_figure(w->stage, key, fit->theta_sigma / DEG, "deg");
	snprintf(key, sizeof key, "%s limbus seen", name);
	stage_figure(w->stage, key, 100 * fit->coverage, "%");
	if (pose->margin < 1)
		stage_skipped(w->stage, "%s: which way the eye is tilted is not sure (log odds %.1f): photograph it from farther "
		              "to one side as well", name, pose->margin);
}

/* The other eye of a face's photograph, where it may be used: its eye's work, and which of its photographs. */
static const struct eye_work *fellow_of(int *at, const struct eye_work *w, int i)
{
	const struct capture_photo *other = capture_fellow(w->capture, w->photo[i]);
	for (int e = 0; other && e < w->capture->n_eyes; e++)
		for (int k = 0; k < w->all[e].n; k++)
			if (w->all[e].photo[k] == other && w->all[e].record[k].ok) {
				*at = k;
				return &w->all[e];
			}
	return 0;
}

static bool pose_of(struct pose *pose, const struct eye_work *w, int i, struct err *err)
{
	int at;
	struct fellow_tilt tilt;
	const struct eye_work *fellow = fellow_of(&at, w, i);
	return (!fellow || limbus_joint_tilt(&tilt, &fellow->joint, &fellow->record[at], &w->o->eye, err))
	       && limbus_joint_pose(pose, &w->joint, &w->record[i], fellow ? &tilt : 0, &w->o->eye, err);
}

static bool finish(struct eye_work *w, int i, int n_in, const char *const in[], struct err *err)
{
	const struct capture_photo *p = w->photo[i];
	const struct limbus_record *r = &w->record[i];
	struct pose pose = { 0 };
	if (!r->ok)
		stage_warn(w->stage, "%s: rejected: %s", p->file, r->reason);
	else if (!pose_of(&pose, w, i, err))
		return err_wrap(err, "%s", p->file);
	if (r->ok && r->rough > 0)
		stage_warn(w->stage, "%s: used roughly, for want of a better photograph of this eye: %s", p->file, r->reason);
	struct fit fit = limbus_joint_fit(r, &pose);
	if (r->ok)
		note(w, i, &fit, &pose);
	else
		stage_skipped_as_said(w->stage, "%s: %s", p->file, r->reason);
	char *png = mem_printf("work/limbus/%s.png", p->name), *extra = r->ok ? extra_of(r, &pose) : refused_of(r);
	bool ok = true;
	if (!stage_fresh(w->stage, p->fit, n_in, in))
		ok = fit_save(&fit, stage_path(w->stage, "%s", p->fit), stage_made_by(w->stage, n_in, in), extra, err)
		     && stage_made(w->stage, p->fit, n_in, in, err);
	if (ok && (r->ok || r->has_guess) && !stage_fresh(w->stage, png, n_in, in))
		ok = write_overlay(w, i, &fit, png, err) && stage_made(w->stage, png, n_in, in, err);
	if (ok && !r->ok && !r->has_guess)
		ok = file_remove(stage_path(w->stage, "%s", png), err);
	free(png);
	free(extra);
	return ok;
}

/* Where no photograph shows the eye to what is asked, the surest of those that show it roughly is used: an artist is better served by an eye that says
 * so than by none. */
static void take_rough(struct eye_work *w)
{
	struct limbus_record *best = 0;
	for (int i = 0; i < w->n && !w->usable; i++) {
		struct limbus_record *r = &w->record[i];
		const size_t n = strlen(r->reason);
		if (r->rough > w->o->rough_used)
			snprintf(r->reason + n, sizeof r->reason - n, "; limbus.rough_used = %.2g takes it", r->rough);
		else if (r->rough > 0 && (!best || r->gross < best->gross))
			best = r;
	}
	if (best) {
		best->ok = true;
		w->usable = 1;
	}
}

/* Reads what was measured, and takes what may be used. */
static bool load(struct eye_work *w, struct err *err)
{
	bool ok = true;
	for (int i = 0; i < w->n && ok; i++) {
		w->path[i] = limbus_record_path(w->photo[i]);
		ok = limbus_record_load(&w->record[i], stage_path(w->stage, "%s", w->path[i]), err);
		w->usable += w->record[i].ok;
	}
	if (ok)
		take_rough(w);
	return ok;
}

/* What all photographs of the eye share. */
static bool share(struct eye_work *w, struct err *err)
{
	int at;
	for (int i = 0; i < w->n; i++) {
		const struct eye_work *fellow = w->record[i].ok ? fellow_of(&at, w, i) : 0;
		if (fellow)
			w->record[i].view.level = limbus_joint_level(&w->record[i], &fellow->record[at]);
	}
	return limbus_joint(&w->joint, w->n, w->record, &w->o->eye, &w->o->pose, err);
}

/* Photograph i's record; with the aspect fitted, those of all of the eye's photographs, and of one that may be used for want of a better. */
static int inputs_of(const char *in[], const struct eye_work *w, int i)
{
	const bool shared = !isfinite(w->o->eye.limbus_aspect) && w->usable >= 2;
	int n = 0;
	for (int j = 0; j < w->n; j++)
		if (shared || j == i || w->record[i].rough > 0)
			in[n++] = w->path[j];
	return n;
}

static bool fit_eye(struct eye_work *w, struct err *err)
{
	const char **in = mem_new(1 + 2 * (size_t)w->capture->n_photos, sizeof *in);
	bool ok = true;
	for (int i = 0; i < w->n && ok; i++) {
		int at, n = 0;
		in[n++] = w->photo[i]->file;
		n += inputs_of(in + n, w, i);
		const struct eye_work *fellow = fellow_of(&at, w, i);
		if (fellow)
			n += inputs_of(in + n, fellow, at);
		ok = finish(w, i, n, in, err);
	}
	free(in);
	return ok;
}

bool limbus_fit_poses(struct limbus_kept *kept, struct stage *stage, const struct capture *capture, const struct limbus_options *o,
                      struct err *err)
{
	struct eye_work all[COUNT(capture->eyes)] = { 0 };
	int usable = 0;
	bool ok = true;
	for (int e = 0; e < capture->n_eyes && ok; e++) {
		struct eye_work *w = &all[e];
		*w = (struct eye_work){ .stage = stage, .capture = capture, .o = o, .kept = kept, .all = all };
		w->photo = mem_new((size_t)capture->n_photos, sizeof *w->photo);
		w->record = mem_new((size_t)capture->n_photos, sizeof *w->record);
		w->path = mem_new((size_t)capture->n_photos, sizeof *w->path);
		for (int i = 0; i < capture->n_photos; i++)
			if (capture->photos[i].eye == e)
				w->photo[w->n++] = &capture->photos[i];
		ok = load(w, err);
		usable += w->usable;
	}
	for (int e = 0; e < capture->n_eyes && ok; e++)
		ok = share(&all[e], err);
	for (int e = 0; e < capture->n_eyes && ok; e++)
		ok = fit_eye(&all[e], err);
	for (int e = 0; e < capture->n_eyes; e++) {
		for (int i = 0; i < all[e].n; i++)
			free(all[e].path[i]);
		free(all[e].path);
		free(all[e].photo);
		free(all[e].record);
	}
	if (ok && usable == 0)
		return err_set(err, "photos/: none of the %d photographs can be used; the reasons are above", capture->n_photos);
	return ok;
}
