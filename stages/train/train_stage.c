#include "stages/train/train_stage.h"

#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/chart.h"
#include "stages/train/clip.h"

static const char *const parts[TRAIN_PARTS] = { "left lids", "right lids", "skin" };
static const char *const keys[TRAIN_PARTS] = { "lids_left", "lids_right", "skin" };
static const char *const curves_rel = "work/skin/curves.svg", *const report_rel = "work/skin/train.json";

/* Draws figure 3.7: held-out error against the number of components. */
static bool draw(const struct train_report *r, const struct train_conf *conf, const char *path, const char *made_by,
                 struct err *err)
{
	static const char *const titles[TRAIN_PARTS] = { "Left lids from gaze and aperture", "Right lids from gaze and aperture",
		                                             "Skin from lids and expressions" };
	struct chart_panel panels[TRAIN_PARTS];
	struct chart_series series[TRAIN_PARTS][5];
	double *x = mem_new(257, sizeof *x), at[TRAIN_PARTS][2], span[2] = { 0, 1 };
	int n = 0;
	for (int k = 0; k < 257; k++)
		x[k] = k + 1;
	for (int p = 0; p < TRAIN_PARTS; p++) {
		const struct train_curve *c = &r->curve[p];
		int lines = 0, k = c->kept - 1;
		if (!c->n)
			continue;
		series[n][lines++] = (struct chart_series){ "linear", "#d62728", 0, c->n, x, c->linear, c->linear_sigma, true, false };
		if (!conf->brief)
			series[n][lines++] = (struct chart_series){ "radial basis functions", "#1f77b4", 0, c->n, x, c->rbf, c->rbf_sigma,
				                                        true, false };
		series[n][lines++] = (struct chart_series){ "components alone", "#7f7f7f", "5 4", c->n, x, c->pca, 0, false, false };
		series[n][lines++] = (struct chart_series){ "linear, random frames", "#ff9896", "5 4", c->n, x, c->random, 0, false, false };
		at[n][0] = at[n][1] = k + 1;
		series[n][lines++] = (struct chart_series){ "kept", "#2ca02c", "2 3", 2, at[n], span, 0, false, false };
		double top = 0;
		for (int i = 0; i < c->n; i++)
			top = fmax(top, fmax(c->linear[i], conf->brief ? 0 : c->rbf[i]));
		panels[n] = (struct chart_panel){ titles[p], "principal components", "held-out normalised error", lines, series[n], 0,
			                              fmin(1.05 * top, 1.2) };
		n++;
	}
	bool ok = chart_save(path, n, 420, 320, n, panels, made_by, err);
	free(x);
	return ok;
}

static json_t *curve_json(const struct train_report *r, int p)
{
	const struct train_curve *c = &r->curve[p];
	json_t *j = json_object();
	json_object_set_new(j, "linear", json_numbers(c->n, c->linear));
	json_object_set_new(j, "linear_sigma", json_numbers(c->n, c->linear_sigma));
	json_object_set_new(j, "rbf", json_numbers(c->n, c->rbf));
	json_object_set_new(j, "rbf_sigma", json_numbers(c->n, c->rbf_sigma));
	json_object_set_new(j, "linear_random_frames", json_numbers(c->n, c->random));
	json_object_set_new(j, "components_alone", json_numbers(c->n, c->pca));
	json_object_set_new(j, "kept", json_integer(c->kept));
	json_object_set_new(j, "held_out_px", json_number(c->linear_px));
	json_object_set_new(j, "ridge", json_number(c->ridge));
	json_object_set_new(j, "rbf_functions", json_integer(c->rbf_functions));
	json_object_set_new(j, "rbf_width", json_number(c->rbf_width));
	json_object_set_new(j, "rank", json_integer(r->rank[p]));
	json_object_set_new(j, "rank_inputs", json_integer(r->rank_inputs[p]));
	json_object_set_new(j, "components_for_95_percent", json_integer(r->components95[p]));
	json_object_set_new(j, "components_for_99_percent", json_integer(r->components99[p]));
	json_object_set_new(j, "frames", json_integer(r->used[p]));
	json_object_set_new(j, "outside_frames", json_integer(r->outside[p]));
	json_object_set_new(j, "outlying_share", json_number(r->outlying[p]));
	json_object_set_new(j, "filled_share", json_number(r->filled[p]));
	return j;
}

static bool save_report(const struct train_report *r, const char *path, const char *made_by, struct err *err)
{
	json_t *j = json_object(), *warnings = json_array();
	for (int p = 0; p < TRAIN_PARTS; p++)
		if (r->curve[p].n)
			json_object_set_new(j, keys[p], curve_json(r, p));
	for (int i = 0; i < r->n_warnings; i++)
		json_array_append_new(warnings, json_string(r->warnings[i]));
	json_object_set_new(j, "folding_px", json_number(r->folding_px));
	json_object_set_new(j, "unseen_vertices", json_integer(r->unseen_vertices));
	json_object_set_new(j, "warnings", warnings);
	bool ok = json_write(path, j, made_by, err);
	json_decref(j);
	return ok;
}

/* Log, figures and warnings. */
static void tell(struct stage *stage, const struct train_report *r, const struct train_conf *conf,
                 const struct skin_model *model)
{
	for (int p = 0; p < TRAIN_PARTS; p++) {
		const struct train_curve *c = &r->curve[p];
		if (!c->n) {
			if (p != TRAIN_SKIN)
				stage_skipped(stage, "%s: not modelled: this eye's gaze or lids were not measured in enough frames", parts[p]);
			continue;
		}
		int k = c->kept - 1;
		char rbf[64] = "";
		if (!conf->brief)
			snprintf(rbf, sizeof rbf, " (radial basis functions %.3f)", c->rbf[k]);
		int most = p == TRAIN_SKIN ? conf->skin_components : conf->lid_components;
		stage_note(stage, "%s: %ld frames, %d components, %d hold 99 %%; held-out error %.3f%s, %.2f px; ridge %g", parts[p],
		           r->used[p], k + 1, r->components99[p], c->linear[k], rbf, c->linear_px, c->ridge);
		if (conf->choose && k + 1 < most)
			stage_skipped(stage, "%s: %d of %d components: frames held out are predicted no better with more", parts[p], k + 1, most);
		char key[64];
		snprintf(key, sizeof key, "train_%s_error", keys[p]);
		stage_figure(stage, key, c->linear[k], "");
		snprintf(key, sizeof key, "train_%s_px", keys[p]);
		stage_figure(stage, key, c->linear_px, "px");
		if (conf->brief)
			continue;
		snprintf(key, sizeof key, "train_%s_error_rbf", keys[p]);
		stage_figure(stage, key, c->rbf[k], "");
	}
	if (!model->n_vertices)
		stage_skipped(stage, "skin: not modelled: none was followed, for want of a mesh of the person (subject.ply)");
	for (int i = 0; i < r->n_warnings; i++)
		stage_skipped(stage, "%s", r->warnings[i]);
	if (r->unseen_vertices)
		stage_skipped(stage, "%d of %d skin points were seen in too few frames: the character's follow their neighbours",
		              r->unseen_vertices, model->n_vertices);
	stage_figure(stage, "train_folding", r->folding_px, "px");
	stage_figure(stage, "train_aperture_sigma", model->aperture_sigma, "px");
}

/* Names of the action units, rows of the mesh, camera and eyes, which train_run does not fill in. */
static void identify(struct skin_model *model, struct clip *clip)
{
	model->camera = clip->camera;
	model->eyes = clip->eyes;
	model->reference_frame = (int)clip->train.reference;
	for (int i = 0; i < model->n_vertices; i++)
		model->vertices[i] = clip->vertices[i];
	for (int i = 0; i < model->n_au; i++)
		model->au_names[i] = mem_str(clip->au_names[i]);
}

static bool all_fresh(struct stage *stage, int n, const char *const in[])
{
	bool fresh = stage_fresh(stage, curves_rel, n, in);
	fresh = stage_fresh(stage, report_rel, n, in) && fresh;
	for (int i = 0; skin_model_files[i]; i++) {
		char *rel = mem_printf("work/skin/%s", skin_model_files[i]);
		fresh = stage_fresh(stage, rel, n, in) && fresh;
		free(rel);
	}
	return fresh;
}

static bool all_made(struct stage *stage, int n, const char *const in[], struct err *err)
{
	bool ok = stage_made(stage, curves_rel, n, in, err) && stage_made(stage, report_rel, n, in, err);
	for (int i = 0; skin_model_files[i] && ok; i++) {
		char *rel = mem_printf("work/skin/%s", skin_model_files[i]);
		ok = stage_made(stage, rel, n, in, err);
		free(rel);
	}
	return ok;
}

bool train_stage(struct stage *stage, const struct train_conf *conf, const struct opt_each_list *expressions,
                 struct err *err)
{
	const char *in[8];
	int n;
	clip_inputs(in, &n, stage);
	if (all_fresh(stage, n, in))
		return true;
	struct clip clip = { 0 };
	struct skin_model model = { 0 };
	struct train_report report = { 0 };
	const char *made_by = stage_made_by(stage, n, in);
	bool ok = clip_load(&clip, stage, expressions, err) && train_run(&model, &report, &clip.train, conf, err);
	if (ok)
		identify(&model, &clip);
	ok = ok && skin_model_save(&model, stage_path(stage, "work/skin"), made_by, err)
	     && draw(&report, conf, stage_path(stage, "%s", curves_rel), made_by, err)
	     && save_report(&report, stage_path(stage, "%s", report_rel), made_by, err) && all_made(stage, n, in, err);
	if (ok)
		tell(stage, &report, conf, &model);
	train_report_free(&report);
	skin_model_free(&model);
	clip_free(&clip);
	return ok;
}
