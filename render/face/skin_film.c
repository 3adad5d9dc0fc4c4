/* Skin of the person in the film, or in photographs round the head, for a character that has no colours of its own (lib/draw/complexion). */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "draw/complexion/complexion.h"
#include "render/face/skin_tracked.h"
#include "render/face/skin_views.h"

const char *const skin_sources[] = { "auto", "video", "views", "plain", 0 };
const char *const hair_sources[] = { "auto", "average", 0 };

enum { LONGEST = 3600, SPREAD = 9 };
static const double lids_mm = 0.45;   // margins are moist and lashes grow on them: so far off the opening skin is dry
static const double turned = 0.14;    // radians: a head turned further than this stands in another light
static const double sure_least = 0.3;

static const char *inside(struct stage *stage, const char *path)
{
	return path + strlen(stage->capture) + 1;
}

__attribute__((format(printf, 3, 4)))
static void tell(struct skin_target *t, const char *from, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	t->told = (struct skin_told){ .from = from };
	vsnprintf(t->told.why.msg, sizeof t->told.why.msg, fmt, ap);
	va_end(ap);
}

static const char own[] = "own", video[] = "video", views[] = "views", one_colour[] = "one colour";

/* Why it has one colour where that is asked for: by capture.conf, or by the preset. */
static void tell_plain(struct skin_target *t, struct stage *stage)
{
	const struct conf_item *said = conf_find(&stage->conf, "render.skin", 0), *quality = conf_find(&stage->conf, "quality", 0);
	const bool preset = !(said && said->layer) && quality;
	tell(t, one_colour, "its file brings no materials, and render.skin = plain%s%s", preset ? ", as the preset has it: quality = " : "", preset ? quality->value : "");
}

/* What the character's skin needs of the film, or of its eyes alone. False where a file is not there: missing, to be freed. */
static bool has_tracked(char **missing, struct skin_target *t, struct stage *stage, bool eyes_alone)
{
	static const char *const beside[] = { "registered.ply", "registration.json" };
	const int n = t->n_in;
	for (int i = 0; i < TRACKED_FILES + COUNT(beside); i++) {
		if (eyes_alone && i < TRACKED_FILES && i != TRACKED_JSON && i != TRACKED_HEAD && i != TRACKED_LIDS)
			continue;
		*missing = i < TRACKED_FILES ? mem_str(tracked_files[i]) : mem_printf("work/targets/%s/%s", t->name, beside[i - TRACKED_FILES]);
		if (!file_exists(stage_path(stage, "%s", *missing))) {
			t->n_in = n;
			return false;
		}
		t->in[t->n_in++] = inside(stage, stage_path(stage, "%s", *missing));
		free(*missing);
	}
	*missing = 0;
	return true;
}

bool skin_is_inside(struct stage *stage, const char *rel)
{
	return rel && !strstr(rel, "..") && *rel != '/' && file_exists(stage_path(stage, "%s", rel));
}

/* The film that was followed, and the mesh. False, lacks set to a sentence's end: they are not there. */
static bool find_film(struct skin_target *t, struct stage *stage, struct err *lacks)
{
	struct err none = { 0 }, nor = { 0 };
	const int n = t->n_in;
	char *missing;
	if (!has_tracked(&missing, t, stage, false)) {
		stage_skipped_as_said(stage, "skin of %s from a video: %s is not there", t->name, missing);
		err_set(lacks, "of the video %s is not there", missing);
		free(missing);
		return false;
	}
	json_t *track = json_read(stage_path(stage, "%s", tracked_files[TRACKED_JSON]), 1 << 24, &none);
	json_t *laid = json_read(stage_path(stage, "work/targets/%s/registration.json", t->name), 1 << 24, &nor);
	const char *film = json_string_value(json_object_get(track, "video")), *subject = json_string_value(json_object_get(laid, "subject"));
	const bool there = skin_is_inside(stage, film) && skin_is_inside(stage, subject);
	if (there) {
		t->in[t->n_in++] = t->film = inside(stage, stage_path(stage, "%s", film));
		t->in[t->n_in++] = t->subject = inside(stage, stage_path(stage, "%s", subject));
		tell(t, video, "of the person in %s", t->film);
	} else {
		t->n_in = n;
		err_set(lacks, "the video or the mesh that were followed are not there");
	}
	json_decref(track);
	json_decref(laid);
	return there;
}

/* Photographs round the head, in place of the film or where it does not serve. */
static bool find_views(struct skin_target *t, struct stage *stage, struct err *lacks)
{
	const int n = t->n_in;
	char *missing = 0;
	if (!t->film && !has_tracked(&missing, t, stage, true)) {
		err_set(lacks, "%s is not there", missing);
		free(missing);
		return false;
	}
	skin_views_find(t, stage, lacks);
	if (!t->views && !t->film)
		t->n_in = n;
	else if (!t->film)
		tell(t, views, "of the person in views/");
	return t->views > 0;
}

void skin_film(struct skin_target *t, struct stage *stage, const struct skin_conf *conf)
{
	struct err lacks = { 0 }, nor = { 0 };
	if (!t->name)
		return;
	if (t->look_path)
		tell(t, own, "as its file has it");
	else if (conf->source == SKIN_PLAIN)
		tell_plain(t, stage);
	if (t->told.from)
		return;
	bool found = conf->source != SKIN_VIEWS && find_film(t, stage, &lacks);
	if (conf->source != SKIN_VIDEO)
		found |= find_views(t, stage, &nor);
	if (!found)
		tell(t, one_colour, "its file brings no materials, and %s", conf->source == SKIN_VIEWS ? nor.msg : lacks.msg);
}

/* How wide the lids stand apart, px: the mean over both eyes. NAN: not known. */
static double opening(const struct tracked *f, long frame)
{
	const long m = f->lids.shape[2];
	const float *p = (const float *)f->lids.data + frame * TRACKED_MARGINS * m * 2;
	double sum = 0;
	for (int s = 0; s < 2; s++)
		sum += 0.5 * (double)(p[2 * ((2 * s + 1) * m + m / 2) + 1] - p[2 * (2 * s * m + m / 2) + 1]);
	return sum;
}

/* Whether a frame is of use: its head is known, and stands as in the reference. */
static bool usable(const struct tracked *f, long frame)
{
	const double (*a)[4] = tracked_pose(f, frame), (*b)[4] = tracked_pose(f, f->reference);
	double trace = 0;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			trace += a[i][k] * b[i][k];
	return isfinite(trace) && trace > 1 + 2 * cos(turned) && isfinite(a[2][3]) && isfinite(opening(f, frame));
}

/* The reference, frames spread over the film, and those in which the lids are lowest: they show the upper lids' skin. Rising from the
 * second on. Returns how many. */
static int choose(long out[COMPLEXION_VIEWS], const struct tracked *f)
{
	const long first = f->reference > LONGEST / 2 ? f->reference - LONGEST / 2 : 0, last = first + LONGEST < f->frames ? first + LONGEST : f->frames;
	int n = 0;
	out[n++] = f->reference;
	for (int k = 0; k < SPREAD - 1; k++)
		for (long i = first + k * (last - first) / (SPREAD - 1); i < first + (k + 1) * (last - first) / (SPREAD - 1); i++)
			if (i != f->reference && usable(f, i) && (i - first) * (SPREAD - 1) * 2 >= (2 * k + 1) * (last - first)) {
				out[n++] = i;
				break;
			}
	while (n < COMPLEXION_VIEWS) {
		long best = -1;
		for (long i = first; i < last; i++) {
			bool taken = !usable(f, i);
			for (int k = 0; k < n && !taken; k++)
				taken = labs(out[k] - i) < 3;
			if (!taken && (best < 0 || opening(f, i) < opening(f, best)))
				best = i;
		}
		if (best < 0)
			break;
		out[n++] = best;
	}
	for (int i = 2; i < n; i++)
		for (int k = i; k > 1 && out[k] < out[k - 1]; k--) {
			const long t = out[k];
			out[k] = out[k - 1];
			out[k - 1] = t;
		}
	return n;
}

/* Where the mesh's vertices are in a frame: those that were followed there, the others where the head has them. */
static void place(float (*at)[3], const struct tracked *f, long frame)
{
	const double (*pose)[4] = tracked_pose(f, frame);
	const long m = f->vertices.shape[0];
	const float (*px)[2] = (const float(*)[2])f->skin.data + frame * m, *sure = (const float *)f->sure.data + frame * m;
	const int32_t *row = f->vertices.data;
	for (int i = 0; i < f->mesh.n_vertices; i++) {
		double c[3], p[2];
		for (int k = 0; k < 3; k++)
			c[k] = pose[k][0] * (double)f->mesh.vertices[i][0] + pose[k][1] * (double)f->mesh.vertices[i][1] + pose[k][2] * (double)f->mesh.vertices[i][2] + pose[k][3];
		const bool there = camera_project(p, &f->camera, c);
		at[i][0] = there ? (float)p[0] : NAN;
		at[i][1] = there ? (float)p[1] : NAN;
		at[i][2] = (float)c[2];
	}
	for (long i = 0; i < m; i++)
		if (isfinite(px[i][0] + px[i][1]) && (double)sure[i] > sure_least)
			memcpy(at[row[i]], px[i], sizeof px[i]);
}

static void add(struct complexion *c, const struct tracked *f, long frame, const uint8_t *rgb)
{
	float (*at)[3] = mem_array((size_t)f->mesh.n_vertices + 1, sizeof *at);
	uint8_t *open = mem_array((size_t)f->width * (size_t)f->height + 1, 1);
	place(at, f, frame);
	const long m = f->lids.shape[2];
	const float (*lids)[2] = (const float(*)[2])f->lids.data + frame * TRACKED_MARGINS * m;
	const double around = lids_mm * f->camera.focal_px / fmax(tracked_pose(f, frame)[2][3], 1);
	tracked_mark_open(open, f->width, f->height, lids, m, (double[]){ around, around });
	complexion_add(c, &(struct complexion_view){ rgb, f->width, f->height, (const float(*)[3])at, f->camera.focal_px, open, lids, (int)m, 0 });
	free(at);
	free(open);
}

static void keep(void *to, int i, uint8_t *rgb)
{
	((uint8_t **)to)[i] = rgb;
}

/* The reference, which the film does not begin with, is the first to be looked at. */
static bool look_at(struct complexion *c, const struct tracked *f, struct skin_job *job, const char *path, struct err *err)
{
	long frame[COMPLEXION_VIEWS];
	uint8_t *kept[COMPLEXION_VIEWS] = { 0 };
	const int n = choose(frame, f);
	const bool ok = tracked_decode(n, frame, f, job, path, &(struct tracked_take){ keep, kept }, err);
	for (int i = 0; i < n; i++)
		if (ok && kept[i] && kept[0])
			add(c, f, frame[i], kept[i]);
	for (int i = 0; i < n; i++)
		free(kept[i]);
	return ok;
}

static bool wear(struct skin_target *t, const struct complexion *c, struct skin_job *job, struct err *err)
{
	const struct rig *rig = &t->rig;
	const int n = rig_own_vertices(rig), n_faces = rig_own_faces(rig);
	struct mesh registered = { 0 };
	bool ok = om_mesh_load(&registered, stage_path(job->stage, "work/targets/%s/registered.ply", t->name), 10000000, err);
	if (ok && registered.n_vertices != n)
		ok = err_set(err, "work/targets/%s/registered.ply: not the rig's vertices: run extrapolate again", t->name);
	bool *skin = mem_new((size_t)n_faces + 1, sizeof *skin);
	float *margin = mem_new((size_t)n + 1, sizeof *margin);
	for (int i = 0; i < n_faces; i++)
		skin[i] = rig->part[rig->faces[i][0]] == RIG_SKIN;
	for (int i = 0; i < n; i++)
		margin[i] = (float)exp(-pow(fmax((double)rig->gap[i] - 0.2, 0) / (0.055 * rig->globe[rig->side[i]].radius), 2));
	struct complexion_wearer w = { n, n_faces, (const int32_t(*)[3])rig->faces, (const float(*)[3])rig->rest, (const float(*)[3])rig->normal,
		                           (const float(*)[3])registered.vertices, skin, margin, { { 0 } }, { { 0 } } };
	for (int s = 0; s < 2; s++)
		memcpy(w.eye[s], rig->globe[s].center, sizeof w.eye[s]);
	memcpy(w.head_from_rest, rig->head_from_target, sizeof w.head_from_rest);
	ok = ok && complexion_wear(&t->look, c, &w, err);
	if (ok) {
		t->film_hair = mem_new(1, sizeof *t->film_hair);
		*t->film_hair = *complexion_hair(c);
		t->film_place = (float(*)[3])registered.vertices;
		registered.vertices = 0;
	}
	free(skin);
	free(margin);
	mesh_free(&registered);
	return ok;
}

void skin_film_keep(struct skin_job *job, struct skin_target *t)
{
	if ((!t->film && !t->views) || !t->dress || job->worn.name)
		return;
	portrait_free(t->portrait);
	dress_free(t->dress);
	job->worn = (struct skin_worn){ mem_str(t->name), t->look, { t->film_rgb[0], t->film_rgb[1], t->film_rgb[2] }, t->film_hair, t->film_place };
	t->portrait = 0;
	t->dress = 0;
	t->film_hair = 0;
	t->film_place = 0;
	t->look = (struct look){ 0 };
}

/* What was kept for it. */
static bool taken(struct skin_target *t, struct skin_worn *worn)
{
	if (!worn->name || strcmp(worn->name, t->name) != 0)
		return false;
	t->look = worn->look;
	memcpy(t->film_rgb, worn->rgb, sizeof t->film_rgb);
	t->film_hair = worn->hair;
	t->film_place = worn->place;
	free(worn->name);
	*worn = (struct skin_worn){ 0 };
	return true;
}

/* Of the film, or of views/. */
static bool made(struct skin_job *job, struct skin_target *t, bool of_views, struct complexion_report *r, struct err *err)
{
	struct tracked f = { 0 };
	struct complexion_conf conf = { .side = job->conf->film_px, .bumps = 0.07 * job->conf->portrait.texture };
	memcpy(conf.sclera_rgb, job->render->scene.sclera_rgb, sizeof conf.sclera_rgb);
	memcpy(conf.skin_rgb, job->conf->portrait.skin_rgb, sizeof conf.skin_rgb);
	bool ok = of_views ? tracked_load_eyes(&f, job, err) && tracked_load_mesh(&f, job, t, err) : tracked_load(&f, job, t, err);
	if (ok) {
		struct complexion *c = complexion_new(&f.mesh, (const double(*)[3])f.eye, f.radius, &conf);
		ok = (of_views ? skin_views_add(c, &f, job, t, err) : look_at(c, &f, job, stage_path(job->stage, "%s", t->film), err))
		     && complexion_make(c, r, err) && wear(t, c, job, err);
		complexion_free(c);
	}
	tracked_free(&f);
	return ok;
}

bool skin_of_film(struct skin_job *job, struct skin_target *t, struct err *err)
{
	struct err why = { 0 }, nor = { 0 };
	struct complexion_report r;
	if (taken(t, &job->worn)) {
		t->dress = dress_new(&t->look, job->conf->texture_px, &why);
		return true;
	}
	bool ok = t->film && made(job, t, false, &r, &why);
	const bool of_views = !ok && t->views;
	if (of_views) {
		if (t->film)
			stage_skipped(job->stage, "skin of %s from %s: %s: it is that of views/", t->name, t->film, why.msg);
		ok = made(job, t, true, &r, &nor);
	}
	const char *from = of_views ? "views/" : t->film;
	const struct err *last = of_views ? &nor : &why;
	if (!ok && job->conf->source != SKIN_AUTO)
		return err_set(err, "skin of %s from %s: %s", t->name, from, last->msg);
	if (!ok) {
		stage_skipped(job->stage, "skin of %s from %s: %s: it has one colour", t->name, from, last->msg);
		tell(t, one_colour, "its file brings no materials, and %s does not give it: %s", from, last->msg);
		return true;
	}
	stage_note(job->stage, "%s: skin of %s: %.0f %% of the face near the eyes in %s, %.0f %% more on its other half; albedo %.3f %.3f %.3f by %s", t->name,
	           from, 100 * r.seen, of_views ? "them" : "the film", 100 * r.mirrored, r.rgb[0], r.rgb[1], r.rgb[2], r.white ? "the white of the eyes" : "render.skin_rgb's brightness");
	const struct hair_lid *lash = t->film_hair->lid;
	if (lash[HAIR_UPPER].area > 0 && lash[HAIR_LOWER].area > 0)
		stage_note(job->stage, "%s: lashes of %s: seen from in front they reach %.1f mm (upper) and %.1f mm (lower) off the lids in the mean", t->name, from,
		           lash[HAIR_UPPER].reach * t->film_hair->radius / 12, lash[HAIR_LOWER].reach * t->film_hair->radius / 12);
	stage_figure(job->stage, "skin_seen", r.seen, "share of the face near the eyes that the film or the views show");
	stage_figure(job->stage, "skin_grain", r.grain, "rms of the skin's grain, ln");
	tell(t, of_views ? views : video, "of the person in %s, which %s %.0f %% of the face near the eyes; for %.0f %% more its other half stands in, the rest is drawn from its statistics; its light was taken off by %s",
	     from, of_views ? "show" : "shows", 100 * r.seen, 100 * r.mirrored, r.white ? "the white of the eyes" : "render.skin_rgb's brightness");
	t->told.seen = r.seen;
	t->told.mirrored = r.mirrored;
	memcpy(t->film_rgb, r.rgb, sizeof t->film_rgb);
	t->dress = dress_new(&t->look, job->conf->texture_px, &why);
	return true;
}
