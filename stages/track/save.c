#include "stages/track/save.h"

#include <math.h>
#include <stdlib.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "model/gaze_table.h"
#include "track/clip/kappa.h"
#include "track/clip/trust.h"
#include "track/head/pose.h"

enum { EYE_INPUTS = 10, LIDS_ALL = 4 };

const char *const track_files[TRACK_FILES] = {
	"work/skin/gaze.csv",       "work/skin/lids.npy",       "work/skin/lids_model.npy",  "work/skin/vertices.npy", "work/skin/skin.npy",
	"work/skin/skin_model.npy", "work/skin/confidence.npy", "work/skin/head.npy", "work/skin/track.json",
	"work/skin/track.png",
};

/* Columns after the confidences. */
enum { ANGLES = 3, SIGMAS = SIDES * ANGLES, POSE = 6, APERTURES = SIDES * LIDS, SIGHT = SIDES * 2, MORE = SIGMAS + POSE + APERTURES + SIGHT };
static const char *const more[MORE] = { "sigma_g1_deg", "sigma_g2_deg", "sigma_g3_deg", "sigma_g6_deg", "sigma_g7_deg", "sigma_g8_deg",
	                                    "head_h_deg",   "head_v_deg",   "head_t_deg",   "head_x_mm",    "head_y_mm",    "head_z_mm",
	                                    "sigma_g4_px",  "sigma_g5_px",  "sigma_g9_px",  "sigma_g10_px",
	                                    "sight_left_h_deg", "sight_left_v_deg", "sight_right_h_deg", "sight_right_v_deg" };

/* Standard deviations of the gaze (degrees) and the apertures (px) of a frame, the head's pose and the lines of sight; NAN where they are not known. */
static void more_of(double out[MORE], const struct track_result *r, long f)
{
	double fick[3];
	for (int i = 0; i < MORE; i++)
		out[i] = NAN;
	for (int i = 0; i < SIGMAS && r->has_eyes; i++)
		if (isfinite(r->eyes.state[f][i / ANGLES].gaze[i % ANGLES]))
			out[i] = r->eyes.state[f][i / ANGLES].sigma[i % ANGLES] * 180 / M_PI;
	for (int e = 0; e < SIDES && r->has_eyes; e++) {
		double sight[2];
		kappa_sight(sight, r->eyes.state[f][e].gaze, r->kappa.angle[e], e);
		for (int k = 0; k < 2; k++)
			out[SIGMAS + POSE + APERTURES + 2 * e + k] = sight[k] * 180 / M_PI;
	}
	for (int i = 0; i < APERTURES && r->aperture_sigma; i++)
		out[SIGMAS + POSE + i] = r->aperture_sigma[f][i / LIDS][i % LIDS];
	if (r->lost_at[f])
		return;
	head_fick(fick, (const double(*)[4])r->pose[f]);
	for (int k = 0; k < 3; k++) {
		out[SIGMAS + k] = fick[k] * 180 / M_PI;
		out[SIGMAS + 3 + k] = r->pose[f][k][3];
	}
}

static bool save_gaze(const struct track_result *r, const char *path, struct err *err)
{
	int width = EYE_INPUTS + r->n_au, after = 2 + width + SIDES, columns = after + MORE;
	char **name = mem_new((size_t)columns, sizeof *name);
	name[0] = mem_str("frame");
	name[1] = mem_str("time_s");
	for (int i = 0; i < width; i++)
		name[2 + i] = i < EYE_INPUTS ? mem_str(gaze_columns[i]) : mem_printf("au%d", i - EYE_INPUTS + 1);
	name[2 + width] = mem_str("confidence_left");
	name[3 + width] = mem_str("confidence_right");
	for (int i = 0; i < MORE; i++)
		name[after + i] = mem_str(more[i]);
	struct csv_table table = csv_table_new(columns, (const char *const *)name);
	double *row = mem_new((size_t)columns, sizeof *row);
	for (long f = 0; f < r->n; f++) {
		row[0] = (double)f;
		row[1] = r->time[f];
		for (int i = 0; i < width; i++)
			row[2 + i] = r->g ? r->g[f * width + i] : NAN;
		for (int e = 0; e < SIDES; e++)
			row[2 + width + e] = r->has_eyes ? r->eyes.state[f][e].confidence : 0;
		more_of(row + after, r, f);
		csv_add(&table, row);
	}
	bool ok = csv_save(path, &table, err);
	csv_table_free(&table);
	for (int i = 0; i < columns; i++)
		free(name[i]);
	free(name);
	free(row);
	return ok;
}

static json_t *kappa_json(const struct track_kappa *k, int side)
{
	json_t *j = json_object();
	json_object_set_new(j, "nasal_deg", json_number(k->angle[side][0] * 180 / M_PI));
	json_object_set_new(j, "nasal_sigma_deg", json_number(k->sigma[side][0] * 180 / M_PI));
	json_object_set_new(j, "up_deg", json_number(k->angle[side][1] * 180 / M_PI));
	json_object_set_new(j, "up_sigma_deg", json_number(k->sigma[side][1] * 180 / M_PI));
	json_object_set_new(j, "frames", json_integer(k->frames[side]));
	return j;
}

static json_t *globe_json(const struct eye_globe *g)
{
	json_t *j = json_object();
	json_object_set_new(j, "center_in_head_mm", json_numbers(3, g->center_in_head));
	json_object_set_new(j, "center_sigma_mm", json_numbers(3, g->center_sigma));
	json_object_set_new(j, "radius_mm", json_number(g->radius));
	json_object_set_new(j, "limbus_radius_mm", json_number(g->limbus_radius));
	json_object_set_new(j, "rms_px", json_number(g->rms_px));
	json_object_set_new(j, "frames", json_integer(g->frames));
	return j;
}

static json_t *events_json(const struct eye_clip *c, int kind)
{
	static const char *const sides[SIDES] = { "left", "right" };
	json_t *all = json_array();
	for (int i = 0; i < c->events; i++) {
		const struct eye_event *e = &c->event[i];
		if ((int)e->kind != kind)
			continue;
		json_t *j = json_object();
		json_object_set_new(j, "eye", json_string(sides[e->side]));
		json_object_set_new(j, "first", json_integer(e->first));
		json_object_set_new(j, "peak", json_integer(e->peak));
		json_object_set_new(j, "last", json_integer(e->last));
		bool blink = e->kind == EVENT_BLINK;
		json_object_set_new(j, blink ? "amplitude" : "amplitude_deg", json_number(blink ? e->amplitude : e->amplitude * 180 / M_PI));
		if (!blink)
			json_object_set_new(j, "peak_speed_deg_s", json_number(e->peak_speed * 180 / M_PI));
		json_array_append_new(all, j);
	}
	return all;
}

static json_t *trust_json(const struct track_trust *t)
{
	json_t *j = json_object(), *all = json_object();
	json_object_set_new(j, "wrong_probability", json_number(t->wrong));
	for (int i = 0; i < TRUST_EVIDENCES; i++) {
		json_t *one = json_object();
		json_object_set_new(one, "value", json_number(t->value[i]));
		json_object_set_new(one, "log_odds_right", json_number(t->log_odds[i]));
		json_object_set_new(all, trust_names[i].key, one);
	}
	json_object_set_new(j, "far_probability", json_number(t->far));
	json_object_set_new(j, "lens_probability", json_number(t->lens));
	json_object_set_new(j, "evidence", all);
	return j;
}

static json_t *perspective_json(const struct head_lens *lens)
{
	json_t *j = json_object();
	json_object_set_new(j, "share", json_number(lens->share));
	json_object_set_new(j, "sigma", json_number(lens->sigma));
	return j;
}

static bool save_json(const struct track_result *r, const struct track_clip *clip, const char *path, const char *made_by, struct err *err)
{
	json_t *j = json_object(), *camera = json_object();
	json_object_set_new(camera, "width", json_integer(clip->info.width));
	json_object_set_new(camera, "height", json_integer(clip->info.height));
	json_object_set_new(camera, "focal_px", json_number(clip->camera.focal_px));
	json_object_set_new(camera, "center_px", json_numbers(2, clip->camera.center_px));
	json_object_set_new(camera, "distortion", json_numbers(5, clip->camera.distortion));
	json_object_set_new(camera, "cam_from_head", json_numbers(16, &clip->cam_from_head[0][0]));
	json_object_set_new(camera, "focal_assumed", json_boolean(clip->focal_assumed));
	json_object_set_new(j, "camera", camera);
	json_object_set_new(j, "video", json_string(clip->file));
	json_object_set_new(j, "frames", json_integer(r->n));
	json_object_set_new(j, "fps", json_number(clip->info.fps));
	json_object_set_new(j, "variable_rate", json_boolean(clip->info.variable));
	json_object_set_new(j, "reference_frame", json_integer(clip->reference));
	json_object_set_new(j, "pose_rms_px", json_number(clip->pose_px));
	json_object_set_new(j, "trust", trust_json(&r->trust));
	json_object_set_new(j, "perspective", clip->lens.sigma > 0 ? perspective_json(&clip->lens) : json_null());
	json_object_set_new(j, "head_rests", json_boolean(r->rests));
	json_object_set_new(j, "held_by_eyes", json_boolean(r->place_mm > 0));
	json_object_set_new(j, "lost_frames", json_integer(r->lost));
	json_object_set_new(j, "unsure_frames", json_integer(r->unsure));
	json_object_set_new(j, "still_frames", json_integer(r->still));
	json_object_set_new(j, "first_lost_frame", r->cut >= 0 ? json_integer(r->cut) : json_null());
	if (r->has_eyes) {
		json_object_set_new(j, "left_eye", r->eyes.globe[0].seen ? globe_json(&r->eyes.globe[0]) : json_null());
		json_object_set_new(j, "right_eye", r->eyes.globe[1].seen ? globe_json(&r->eyes.globe[1]) : json_null());
		json_object_set_new(j, "left_kappa", kappa_json(&r->kappa, SIDE_LEFT));
		json_object_set_new(j, "right_kappa", kappa_json(&r->kappa, SIDE_RIGHT));
		json_object_set_new(j, "blinks", events_json(&r->eyes, EVENT_BLINK));
		json_object_set_new(j, "saccades", events_json(&r->eyes, EVENT_SACCADE));
	}
	bool ok = json_write(path, j, made_by, err);
	json_decref(j);
	return ok;
}

static bool save_array(struct stage *stage, const char *name, enum npy_type type, int ndim, const long *shape, const void *data,
                       struct err *err)
{
	struct npy a = npy_of(type, ndim, shape, data);
	return npy_save(stage_path(stage, "work/skin/%s", name), &a, err);
}

bool track_save(struct stage *stage, const struct track_result *r, const struct track_clip *clip, const struct track_points *points,
                int n, const char *const in[], struct err *err)
{
	const long m = r->n_points, lids[] = { r->n, LIDS_ALL, r->lid_points, 2 };
	bool ok = file_mkdirs(stage_path(stage, "work/skin"), err)
	          && save_gaze(r, stage_path(stage, "work/skin/gaze.csv"), err)
	          && save_array(stage, "lids.npy", NPY_F4, 4, lids, r->lids, err)
	          && save_array(stage, "lids_model.npy", NPY_F4, 4, lids, r->lids_model, err)
	          && save_array(stage, "vertices.npy", NPY_I4, 1, &m, points->vertex, err)
	          && save_array(stage, "skin.npy", NPY_F4, 3, (long[]){ r->n, m, 2 }, r->skin, err)
	          && save_array(stage, "skin_model.npy", NPY_F4, 3, (long[]){ r->n, m, 2 }, r->skin_model, err)
	          && save_array(stage, "confidence.npy", NPY_F4, 2, (long[]){ r->n, m }, r->confidence, err)
	          && save_array(stage, "head.npy", NPY_F8, 3, (long[]){ r->n, 4, 4 }, r->pose, err)
	          && save_json(r, clip, stage_path(stage, "work/skin/track.json"), stage_made_by(stage, n, in), err);
	for (int i = 0; i < TRACK_FILES && ok; i++)
		ok = stage_made(stage, track_files[i], n, in, err);
	return ok;
}
