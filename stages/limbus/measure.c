#include "limbus.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/aside.h"
#include "base/mem.h"
#include "image/photo/photo.h"
#include "limbus/face/face.h"
#include "limbus/hand.h"
#include "limbus/measure.h"
#include "limbus/strip_net.h"

char *limbus_record_path(const struct capture_photo *photo)
{
	return mem_printf("work/limbus/%s.edge.json", photo->name);
}

#define RIG "work/rig.json"

static char *part_path(const char *name, const char *side, const char *tail)
{
	return mem_printf("work/limbus/%s%s%s%s", name, side ? "." : "", side ? side : "", tail);
}

void limbus_kept_free(struct limbus_kept *kept)
{
	photo_free(&kept->photo);
	free(kept->file);
	*kept = (struct limbus_kept){ 0 };
}

bool limbus_keep(struct limbus_kept *kept, const char *file, const char *path, double limit_mpx, struct err *err)
{
	if (kept->file && !strcmp(kept->file, file))
		return true;
	struct photo photo = { 0 };
	limbus_kept_free(kept);
	if (!photo_load(&photo, path, limit_mpx, err))
		return false;
	*kept = (struct limbus_kept){ mem_str(file), photo };
	return true;
}

/* Loads the networks that are shipped, where they are not loaded, and the photograph, side by side: each takes as long as a third of finding an eye.
 * A photograph that cannot be read is left out. False, err set, when a network cannot be used. */
static bool ready(struct limbus_kept *kept, struct limbus_options *o, const char *file, const char *path, struct err *err)
{
	struct limbus_conf *conf = &o->find;
	struct photo photo = { 0 };
	struct err of_photo = { 0 }, of_strip = { 0 };
	bool is_photo = false, evidence = true, strip = true;
	limbus_kept_free(kept);
#pragma omp parallel sections
	{
#pragma omp section
		is_photo = photo_load(&photo, path, o->limit_mpx, &of_photo);
#pragma omp section
		evidence = conf->net || evidence_open_shipped(&conf->net, err);
#pragma omp section
		strip = (conf->strip || strip_open_shipped(&conf->strip, &of_strip)) && (conf->odds || odds_open_shipped(&conf->odds, &of_strip))
		        && (conf->occlusion || occlusion_open_shipped(&conf->occlusion, &of_strip));
	}
	if (is_photo)
		*kept = (struct limbus_kept){ mem_str(file), photo };
	if (evidence && !strip)
		*err = of_strip;
	return evidence && strip;
}

/* What capture.conf says of where an eye is: of the whole photograph (side null), or of one of its eyes. */
struct hand {
	struct limbus_mark mark;
	struct ellipse meant;
	char key[128];  // that says so; empty: nothing does
};

/* False, err set, where it cannot be meant. */
static bool hand_of(struct hand *hand, const char *photo_name, const char *side, const struct photo *photo, const struct limbus_options *o, struct err *err)
{
	char *name = mem_printf("%s%s%s", photo_name, side ? "." : "", side ? side : "");
	const struct opt_each *hint = capture_each(&o->photo_hint, name), *drawn = capture_each(&o->photo_limbus, name);
	const double *v = drawn ? drawn->value : hint ? hint->value : 0;
	bool ok = true;
	*hand = (struct hand){ 0 };
	if (v) {
		hand->meant = (struct ellipse){ v[0], v[1], v[2], drawn ? v[3] : v[2], drawn ? v[4] * M_PI / 180 : 0 };
		hand->mark = (struct limbus_mark){ hint ? hint->value : 0, drawn ? &hand->meant : 0 };
		snprintf(hand->key, sizeof hand->key, "photo.%.100s.%s", name, drawn ? "limbus_px" : "hint_px");
		ok = limbus_hand_check(&hand->meant, hand->key, photo->width, photo->height, err);
	}
	if (ok && drawn && hint) {
		const struct ellipse hinted = { hint->value[0], hint->value[1], hint->value[2], hint->value[2], 0 };
		ok = limbus_hand_agree(&hinted, "hint_px", &hand->meant, hand->key, true, err);
	}
	free(name);
	return ok;
}

static const char *const sides[] = { [FACE_LEFT] = "left", [FACE_RIGHT] = "right" };

static bool check_mirrored(const struct opt_each_list *list, struct err *err)
{
	for (int i = 0; i < list->n; i++)
		if (strcmp(list->items[i].text, "yes") && strcmp(list->items[i].text, "no"))
			return err_set(err, "capture.conf: photo.%s.mirrored = %.40s: must be yes or no", list->items[i].name, list->items[i].text);
	return true;
}

/* What is said of a photograph, or of each of the eyes it may show; these do not lie in each other. False, err set (both keys), where it
 * does not fit together. */
static bool hands_of(struct hand *whole, struct hand one[2], const struct photo *photo, const char *name, bool may_part,
                     const struct limbus_options *o, struct err *err)
{
	memset(one, 0, 2 * sizeof *one);
	if (!hand_of(whole, name, 0, photo, o, err))
		return false;
	for (int s = 0; s < 2 && may_part; s++) {
		if (!hand_of(&one[s], name, sides[s], photo, o, err))
			return false;
		if (*one[s].key && *whole->key)
			return err_set(err, "%s with %s: the one is for a photograph of one eye, the other for one of two", whole->key, one[s].key);
	}
	return !*one[0].key || !*one[1].key
	       || limbus_hand_agree(&one[0].meant, one[0].key, &one[1].meant, one[1].key, false, err);
}

/* A key of one of two eyes in a photograph of which it is known that it shows one would be passed over. */
static bool check_sides(const struct opt_each_list *list, const char *key, const struct capture *capture, struct err *err)
{
	for (int i = 0; i < list->n; i++)
		for (int k = 0; k < capture->n_photos; k++) {
			const struct capture_photo *p = &capture->photos[k];
			const char *side = capture->eyes[p->eye].side;
			const size_t n = strlen(p->name);
			const char *end = list->items[i].name + n;
			const bool of_part = !strncmp(list->items[i].name, p->name, n) && (!strcmp(end, ".left") || !strcmp(end, ".right"));
			if (of_part && !p->part && (!strcmp(side, sides[FACE_LEFT]) || !strcmp(side, sides[FACE_RIGHT])))
				return err_set(err, "capture.conf: photo.%s.%s: the photograph is one of the %s eye alone: say photo.%s.%s", list->items[i].name, key, side,
				               p->name, key);
		}
	return true;
}

/* One record where the photograph shows one eye, or one is asked for; else two. Returns how many; 0, err set: a key cannot be meant. */
static int measure_photo(struct limbus_record record[2], const struct photo *photo, const struct capture_photo *p, const char *side, bool may_part,
                         const struct limbus_options *o, const struct camera_rig *rig, struct err *err)
{
	const struct opt_each *focal = capture_key(&o->photo_focal, p), *center = capture_key(&o->photo_center, p);
	const struct limbus_camera known = { &o->camera, focal ? focal->value[0] : NAN, center ? center->value : 0, camera_rig_find(rig, p->file) };
	struct hand whole, one[2];
	const struct opt_each *said = capture_each(&o->photo_mirrored, p->name);
	const bool mirrored = said && !strcmp(said->text, "yes");
	if (!hands_of(&whole, one, photo, p->name, may_part, o, err))
		return 0;
	const struct limbus_mark mark[2] = { one[0].mark, one[1].mark };
	if (whole.mark.hint || whole.mark.drawn) {
		limbus_measure_photo(record, photo, whole.mark.hint, whole.mark.drawn, &known, &o->eye, &o->find, &o->pose);
		return 1;
	}
	const int n = limbus_measure_face(record, photo, mark, mirrored, &known, &o->eye, &o->find, &o->pose);
	if (n == 2 && !may_part) {
		if (!strcmp(side, sides[FACE_RIGHT]))
			record[0] = record[1];
		return 1;
	}
	return n;
}

static int measure_one(struct limbus_record record[2], struct limbus_kept *kept, struct stage *stage, const struct capture_photo *p, const char *side,
                       bool may_part, const struct limbus_options *o, const struct camera_rig *rig)
{
	struct err err = { 0 };
	memset(record, 0, 2 * sizeof *record);
	record->width = record->height = 1;
	if (!limbus_keep(kept, p->file, stage_path(stage, "%s", p->file), o->limit_mpx, &err)) {
		snprintf(record->reason, sizeof record->reason, "%.250s", err_less(&err, stage_path(stage, "%s", p->file)));
		return 1;
	}
	int n = measure_photo(record, &kept->photo, p, side, may_part, o, rig, &err);
	if (n)
		return n;
	record->width = kept->photo.width;
	record->height = kept->photo.height;
	snprintf(record->reason, sizeof record->reason, "%.250s", err.msg);
	return 1;
}

/* Puts aside what the photograph left when it was taken for one eye (parts false), or for two. */
static bool clear(struct stage *stage, const char *name, bool parts, struct err *err)
{
	static const char *const tails[] = { ".edge.json", ".json", ".png" };
	bool ok = true;
	for (int s = 0; s < (parts ? 2 : 1); s++)
		for (int t = 0; t < COUNT(tails) && ok; t++) {
			char *path = part_path(name, parts ? sides[s] : 0, tails[t]);
			ok = aside_put(stage->capture, path, err);
			free(path);
		}
	return ok;
}

static bool save(struct stage *stage, const struct limbus_record *record, const char *name, const char *side, int n_in, const char *const in[], struct err *err)
{
	char *out = part_path(name, side, ".edge.json");
	const bool ok = limbus_record_save(record, stage_path(stage, "%s", out), stage_made_by(stage, n_in, in), err) && stage_made(stage, out, n_in, in, err);
	free(out);
	return ok;
}

static bool is_fresh(struct stage *stage, const char *name, const char *side, int n_in, const char *const in[])
{
	char *out = part_path(name, side, ".edge.json");
	const bool fresh = stage_fresh(stage, out, n_in, in);
	free(out);
	return fresh;
}

/* Measures photograph i where that is not up to date. *parts: 2 where it shows both eyes, else 1. */
static bool measure(int *parts, struct limbus_kept *kept, struct stage *stage, const struct capture *capture, int i, struct limbus_options *o,
                    const struct camera_rig *rig, struct err *err)
{
	const struct capture_photo *p = &capture->photos[i];
	// The rig is an input only of photographs that it has a camera for.
	const int n_in = camera_rig_find(rig, p->file) ? 2 : 1;
	const char *in[] = { p->file, RIG };
	const bool may_part = capture_may_part(capture, i);
	*parts = 1;
	if (is_fresh(stage, p->name, 0, n_in, in))
		return true;
	*parts = 2;
	if (may_part && is_fresh(stage, p->name, sides[0], n_in, in) && is_fresh(stage, p->name, sides[1], n_in, in))
		return true;
	if (!o->find.odds && !ready(kept, o, p->file, stage_path(stage, "%s", p->file), err))
		return false;
	struct limbus_record *record = mem_new(2, sizeof *record);
	*parts = measure_one(record, kept, stage, p, capture->eyes[p->eye].side, may_part, o, rig);
	bool ok = !may_part || clear(stage, p->name, *parts == 1, err);
	for (int s = 0; s < *parts && ok; s++)
		ok = save(stage, &record[s], p->name, *parts == 2 ? sides[s] : 0, n_in, in, err);
	free(record);
	return ok;
}

bool limbus_measure(struct limbus_kept *kept, struct stage *stage, struct capture *capture, struct limbus_options *o, struct err *err)
{
	struct camera_rig rig = { 0 };
	const char *path = stage_path(stage, RIG);
	const bool has_rig = file_exists(path);
	bool ok = check_mirrored(&o->photo_mirrored, err) && check_sides(&o->photo_hint, "hint_px", capture, err)
	          && check_sides(&o->photo_limbus, "limbus_px", capture, err) && (!has_rig || camera_rig_load(&rig, path, err));
	for (int i = 0, parts; i < capture->n_photos && ok; i += parts) {
		stage_progress(stage, i, capture->n_photos, "measure");
		ok = measure(&parts, kept, stage, capture, i, o, &rig, err);
		if (ok && parts == 2)
			capture_part(capture, i);
	}
	camera_rig_free(&rig);
	return ok;
}
