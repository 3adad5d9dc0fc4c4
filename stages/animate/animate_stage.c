#include "stages/animate/animate_stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "stages/animate/draw.h"

static const char *const csv_rel = "work/skin/animation.csv", *const svg_rel = "work/skin/animation.svg";
static const char *const json_rel = "work/skin/animation.json";

/* What script/ holds: one file of each kind. */
struct sources {
	struct script gaze, keys;
	bool has_gaze, has_keys, keys_look;  // keys_look: the keys have targets
	char *gaze_rel, *keys_rel, *video_rel;
	struct animate_places places;
};

static bool ends_with(const char *s, const char *tail)
{
	size_t n = strlen(s), m = strlen(tail);
	return n > m && !strcasecmp(s + n - m, tail);
}

static void sources_free(struct sources *s)
{
	script_free(&s->gaze);
	script_free(&s->keys);
	scene_places_free(&s->places);
	free(s->gaze_rel);
	free(s->keys_rel);
	free(s->video_rel);
}

static bool take_csv(struct sources *s, struct stage *stage, const char *rel, const struct skin_model *model, struct err *err)
{
	struct script script;
	if (!script_read(&script, stage_path(stage, "%s", rel), model, err)) {
		script_free(&script);
		return false;
	}
	bool keys = script.kind == SCRIPT_KEYS;
	if (keys ? s->has_keys : s->has_gaze) {
		stage_warn(stage, "%s: left out: %s comes first", rel, keys ? s->keys_rel : s->gaze_rel);
		script_free(&script);
		return true;
	}
	*(keys ? &s->keys : &s->gaze) = script;
	*(keys ? &s->has_keys : &s->has_gaze) = true;
	*(keys ? &s->keys_rel : &s->gaze_rel) = mem_str(rel);
	s->keys_look = s->keys_look || (keys && script.key[KEY_HORIZONTAL].n);
	return true;
}

static bool look_for(struct sources *s, struct stage *stage, const struct file_list *list, const struct skin_model *model,
                     struct err *err)
{
	static const char *const videos[] = { ".mp4", ".mov", ".mkv", ".avi", ".webm", ".m4v", 0 };
	bool ok = true;
	for (int i = 0; i < list->n && ok; i++) {
		char *rel = mem_printf("script/%s", list->names[i]);
		bool video = false;
		for (int v = 0; videos[v]; v++)
			video = video || ends_with(rel, videos[v]);
		if (ends_with(rel, ".csv"))
			ok = take_csv(s, stage, rel, model, err);
		else if (video && !s->video_rel)
			s->video_rel = mem_str(rel);
		else
			stage_warn(stage, "%s: left out: %s", rel, video ? "one scene is watched, the first" : "must be .csv or a video");
		free(rel);
	}
	if (ok && !s->has_gaze && !s->has_keys && !s->video_rel)
		return err_set(err, "script/: must hold keyframes or recorded gaze (.csv), or a video of a scene");
	return ok;
}

static bool save_json(const struct animation *a, const char *path, const char *made_by, struct err *err)
{
	json_t *j = json_object(), *blinks = json_array(), *saccades = json_array();
	for (int i = 0; i < a->n_blinks; i++) {
		const struct blink *b = &a->blinks[i];
		json_array_append_new(blinks, json_pack("{s:f,s:f,s:f,s:f,s:f}", "start_s", b->start, "down_s", b->down, "hold_s",
		                                        b->hold, "up_s", b->up, "closure", b->closure));
	}
	for (int i = 0; i < a->n_saccades; i++) {
		const struct gaze_saccade *s = &a->saccades[i];
		json_array_append_new(saccades, json_pack("{s:f,s:f,s:f,s:f}", "start_s", s->start, "amplitude_deg", s->amplitude,
		                                          "duration_s", s->duration, "peak_deg_s", s->peak));
	}
	json_object_set_new(j, "frames", json_integer(a->n));
	json_object_set_new(j, "fps", json_real(a->fps));
	json_object_set_new(j, "blinks", blinks);
	json_object_set_new(j, "saccades", saccades);
	bool ok = json_write(path, j, made_by, err);
	json_decref(j);
	return ok;
}

/* Warns of frames whose leverage in the lids' regression is too high: the model extrapolates there. The skin's is not tested:
 * its ridge holds motions of one eye without the other, which a film hardly shows. */
static void tell_outside(struct stage *stage, const struct animation *a, const struct skin_model *model)
{
	long outside = 0, first = 0;
	for (long i = a->n - 1; i >= 0; i--) {
		double h[3];
		skin_model_leverage(h, model, a->g + i * a->n_inputs);
		if (h[0] > SKIN_REACH || h[1] > SKIN_REACH) {
			outside++;
			first = i;
		}
	}
	stage_figure(stage, "animation_outside", (double)outside, "frames");
	if (outside)
		stage_warn(stage, "%ld of %ld frames, the first at %.2f s: no frame of the person's video tells of eyes that look and open so: "
		           "their lids are a guess: film it, or leave it out of the script", outside, a->n, (double)first / a->fps);
}

static void tell(struct stage *stage, const struct animation *a, const struct sources *s)
{
	stage_note(stage, "%ld frames at %g frames/s from %s%s%s: %d saccades, %d blinks", a->n, a->fps,
	           s->keys_look ? s->keys_rel : s->has_gaze ? s->gaze_rel : s->video_rel ? s->video_rel : s->keys_rel,
	           s->has_keys && !s->keys_look ? " with " : "", s->has_keys && !s->keys_look ? s->keys_rel : "", a->n_saccades,
	           a->n_blinks);
	stage_figure(stage, "animation_frames", (double)a->n, "");
	stage_figure(stage, "animation_saccades", a->n_saccades, "");
	stage_figure(stage, "animation_blinks", a->n_blinks, "");
	if (s->keys_look && (s->has_gaze || s->video_rel))
		stage_skipped(stage, "%s: not looked at: the keyframes say where to look", s->has_gaze ? s->gaze_rel : s->video_rel);
	else if (s->has_gaze && s->video_rel)
		stage_skipped(stage, "%s: not watched: the gaze is recorded", s->video_rel);
}

/* A length that ends before a script begins would show nothing of it. */
static bool within(const struct script *script, const char *rel, double duration, struct err *err)
{
	return !rel || isnan(duration) || script->first <= duration
	       || err_set(err, "animate.duration_s = %g with %s, whose first line is at %g s: nothing of it would be shown", duration, rel, script->first);
}

static bool make(struct stage *stage, struct sources *s, const struct skin_model *model, const struct animate_conf *conf,
                 const struct scene_conf *scene, int n, const char *const in[], struct err *err)
{
	bool watch = s->video_rel && !s->keys_look && !s->has_gaze;
	struct animation a = { 0 };
	const char *made_by = stage_made_by(stage, n, in);
	bool ok = within(&s->gaze, s->gaze_rel, conf->duration, err) && within(&s->keys, s->keys_rel, conf->duration, err)
	          && (!watch || scene_places(&s->places, stage, s->video_rel, scene, err))
	          && animate_run(&a, model, s->has_gaze && !s->keys_look ? &s->gaze : 0, s->has_keys ? &s->keys : 0,
	                         watch ? &s->places : 0, conf, err)
	          && animation_save(stage_path(stage, "%s", csv_rel), &a, err)
	          && draw_animation(stage_path(stage, "%s", svg_rel), &a, model, conf, made_by, err)
	          && save_json(&a, stage_path(stage, "%s", json_rel), made_by, err) && stage_made(stage, csv_rel, n, in, err)
	          && stage_made(stage, svg_rel, n, in, err) && stage_made(stage, json_rel, n, in, err);
	if (ok)
		tell(stage, &a, s);
	if (ok)
		tell_outside(stage, &a, model);
	animation_free(&a);
	return ok;
}

bool animate_stage(struct stage *stage, const struct animate_conf *conf, const struct scene_conf *scene, struct err *err)
{
	struct file_list list = { 0 };
	struct skin_model model = { 0 };
	struct sources sources = { 0 };
	if (!stage_list(stage, &list, "script", err))
		return false;
	// Inputs: the model (the lids' baseline), and every file of script/.
	char **in = mem_new((size_t)list.n + 1, sizeof *in);
	int n = 0;
	in[n++] = mem_str("work/skin/model.json");
	for (int i = 0; i < list.n; i++)
		in[n++] = mem_printf("script/%s", list.names[i]);
	const char *const *inputs = (const char *const *)in;
	bool fresh = stage_fresh(stage, csv_rel, n, inputs);
	fresh = stage_fresh(stage, svg_rel, n, inputs) && fresh;
	fresh = stage_fresh(stage, json_rel, n, inputs) && fresh;
	bool ok = fresh
	          || (skin_model_load(&model, stage_path(stage, "work/skin"), err) && look_for(&sources, stage, &list, &model, err)
	              && make(stage, &sources, &model, conf, scene, n, inputs, err));
	for (int i = 0; i < n; i++)
		free(in[i]);
	free(in);
	file_list_free(&list);
	skin_model_free(&model);
	sources_free(&sources);
	return ok;
}
