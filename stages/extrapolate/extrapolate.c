#include "stages/extrapolate/extrapolate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "bridge/om_mesh.h"
#include "character/import.h"
#include "image/exr.h"
#include "rig/deform/clearance.h"

/* A character as read. */
struct character {
	struct mesh mesh, registered;
	struct npy start, column, weight, confidence;
	double *weights;
	struct rig_character rig;
};

static void character_free(struct character *c)
{
	mesh_free(&c->mesh);
	mesh_free(&c->registered);
	npy_free(&c->start);
	npy_free(&c->column);
	npy_free(&c->weight);
	npy_free(&c->confidence);
	free(c->weights);
}

static bool read_weights(struct character *c, const char *path, int n, struct err *err)
{
	if (!npz_read(&c->start, path, "indptr", NPY_LIMIT, err) || !npz_read(&c->column, path, "indices", NPY_LIMIT, err)
	    || !npz_read(&c->weight, path, "data", NPY_LIMIT, err) || !npz_read(&c->confidence, path, "confidence", NPY_LIMIT, err))
		return false;
	if (c->start.type != NPY_I4 || c->column.type != NPY_I4 || c->confidence.type != NPY_F4)
		return err_set(err, "%s: other types of numbers than transfer writes: run it again", path);
	long entries = npy_count(&c->column);
	const int32_t *start = c->start.data, *column = c->column.data;
	if (npy_count(&c->start) != n + 1 || start[0] != 0 || start[n] != entries || npy_count(&c->weight) != entries
	    || npy_count(&c->confidence) != n)
		return err_set(err, "%s: its rows are not the %d vertices of registered.ply: run transfer again", path, n);
	for (int i = 0; i < n; i++)
		if (start[i] > start[i + 1])
			return err_set(err, "%s: indptr: must not fall", path);
	for (long k = 0; k < entries; k++)
		if (column[k] < 0)
			return err_set(err, "%s: indices: %d is no vertex", path, column[k]);
	c->weights = npy_doubles(&c->weight);
	return true;
}

static void expect_eyes(struct rig_character *rig, const struct extrapolate_conf *conf, double unit)
{
	static const char *const sides[] = { "left", "right" };
	rig->eye_radius = conf->eye_radius * unit;
	for (int s = 0; s < 2; s++)
		for (int c = 0; c < 3; c++)
			rig->eye_center[s][c] = NAN;
	for (int i = 0; i < conf->eye_center.n; i++)
		for (int s = 0; s < 2; s++)
			if (!strcmp(conf->eye_center.items[i].name, sides[s]))
				for (int c = 0; c < 3; c++)
					rig->eye_center[s][c] = conf->eye_center.items[i].value[c] * unit;
}

static bool read_character(struct character *c, struct stage *stage, const char *const in[], const struct extrapolate_conf *conf,
                           struct err *err)
{
	json_t *json = 0;
	double to_mm = 1, subject_unit = 1;
	bool ok = om_mesh_load(&c->mesh, stage_path(stage, "%s", in[0]), (long)conf->limit_vertices, err)
	          && om_mesh_load(&c->registered, stage_path(stage, "%s", in[1]), (long)conf->limit_vertices, err);
	if (ok && c->mesh.n_vertices != c->registered.n_vertices)
		ok = err_set(err, "%s: %d vertices, but %s has %d: run transfer again", in[1], c->registered.n_vertices, in[0],
		             c->mesh.n_vertices);
	ok = ok && read_weights(c, stage_path(stage, "%s", in[2]), c->mesh.n_vertices, err)
	     && (json = json_read(stage_path(stage, "%s", in[3]), 1 << 24, err))
	     && json_get_array(&c->rig.subject_from_target[0][0], 16, json, "subject_from_target", in[3], err)
	     && json_get(&to_mm, json, "target_unit_mm", in[3], err) && json_get(&subject_unit, json, "subject_unit_mm", in[3], err);
	json_decref(json);
	for (int i = 0; ok && i < c->mesh.n_vertices; i++)
		for (int k = 0; k < 3; k++)
			c->mesh.vertices[i][k] *= (float)to_mm;
	if (!ok)
		return false;
	// transfer winds the faces of a mesh that looks inwards the other way; those of registered.ply count.
	if (c->mesh.n_faces == c->registered.n_faces)
		memcpy(c->mesh.faces, c->registered.faces, (size_t)c->mesh.n_faces * sizeof *c->mesh.faces);
	c->rig.mesh = &c->mesh;
	c->rig.registered = (const float(*)[3])c->registered.vertices;
	c->rig.b_start = c->start.data;
	c->rig.b_column = c->column.data;
	c->rig.b_weight = c->weights;
	c->rig.confidence = c->confidence.data;
	expect_eyes(&c->rig, conf, isfinite(conf->subject_unit) ? conf->subject_unit : subject_unit);
	return true;
}

static bool save_map(struct stage *stage, const char *rel, struct image image, int n, const char *const in[], struct err *err)
{
	static const char *const rgb[] = { "R", "G", "B" }, *const y[] = { "Y" };
	struct exr_info info = { .made_by = stage_made_by(stage, n, in) };
	bool ok = exr_write(stage_path(stage, "%s", rel), &image, image.channels == 3 ? rgb : y, EXR_FLOAT, &info, err)
	          && stage_made(stage, rel, n, in, err);
	image_free(&image);
	return ok;
}

static void report(struct stage *stage, const char *name, const struct rig *rig, const struct rig_report *r, const struct rig_motion *motion)
{
	stage_note(stage, "%s: %d vertices tracked, %d on the lid margins, %d extrapolated, %d still; globes of %.1f and %.1f mm%s",
	           name, r->tracked, r->lid, r->extrapolated, r->still, rig->globe[0].radius, rig->globe[1].radius,
	           rig->globe[0].own && rig->globe[1].own ? "" : " (spheres)");
	stage_figure(stage, "tracked_vertices", r->tracked, "");
	stage_figure(stage, "lid_vertices", r->lid, "");
	stage_figure(stage, "extrapolated_vertices", r->extrapolated, "");
	stage_figure(stage, "globe_radius", 0.5 * (rig->globe[0].radius + rig->globe[1].radius), "mm");
	stage_figure(stage, "lids_beside_skin", motion->lid_error_skin, "px rms: what the skin's components do not know of the lids");
	stage_figure(stage, "lids_folded_error", motion->lid_error, "px rms: what is left of it with components of the lids' own");
	stage_figure(stage, "least_distance", deform_clearance(rig), "mm of skin from an eyeball, over 27 poses");
	stage_figure(stage, "off_chart", r->off_chart, "px, median: the model's skin at rest against the registered mesh as the camera sees it");
	if (r->off_chart > 12)
		stage_skipped(stage, "%s: its skin is seen %.0f px from where it was tracked: check camera.focal_px, subject.unit_mm and subject.landmark.*",
		              name, r->off_chart);
	stage_figure(stage, "open_when_closed", fmax(r->open_before[0], r->open_before[1]), "mm that the learnt motion leaves open of closed eyes");
	stage_figure(stage, "open_after_sealing", fmax(r->open_after[0], r->open_after[1]), "mm");
	if (fmax(r->open_after[0], r->open_after[1]) > 0.5)
		stage_skipped(stage, "%s: its closed eyes stay open by %.1f mm: film a full blink, or check subject.landmark.* and the target's lids",
		              name, fmax(r->open_after[0], r->open_after[1]));
	if (r->inside_at_rest)
		stage_note(stage, "%s: %d vertices lie up to %.2f mm inside an eyeball at rest: they are put before it", name,
		           r->inside_at_rest, r->deepest);
	if (r->cornea_added[0] || r->cornea_added[1])
		stage_note(stage, "%s: its eyeballs are mere balls: they get a cornea", name);
}

enum { OUT = 5 };

/* why: set where this character cannot be rigged; what was made of it before is gone then. */
static bool rig_one(struct err *why, struct stage *stage, const char *name, const char *const out[OUT], int n, const char *const in[],
                    const struct rig_motion *motion, const struct extrapolate_conf *conf, struct err *err)
{
	struct character c = { 0 };
	struct rig rig = { 0 };
	struct rig_report found;
	bool ok = read_character(&c, stage, in, conf, err), made = ok && rig_make(&rig, &found, motion, &c.rig, &conf->rig, why);
	if (ok && !made) {
		err_wrap(why, "targets/%s", name);
		for (int i = 0; i < OUT && ok; i++)
			ok = file_remove(stage_path(stage, "%s", out[i]), err);
		character_free(&c);
		return ok;
	}
	ok = ok && rig_save(&rig, stage_path(stage, "%s", out[0]), stage_made_by(stage, n, in), err)
	     && stage_made(stage, out[0], n, in, err) && save_map(stage, out[1], skull_map_positions(&rig.skull), n, in, err)
	     && save_map(stage, out[2], skull_map_normals(&rig.skull), n, in, err);
	for (int s = 0; s < 2 && ok; s++)
		ok = save_map(stage, out[3 + s], globe_map_polar(&rig.globe[s].map, conf->polar_px), n, in, err);
	if (ok)
		report(stage, name, &rig, &found, motion);
	rig_free(&rig);
	character_free(&c);
	return ok;
}

/* The rig of targets/FILE, unless it is up to date. Returns whether there is one; why: set where the character cannot be rigged. */
static bool target(struct err *why, struct stage *stage, const char *file, const struct rig_motion *motion,
                   const struct extrapolate_conf *conf, struct err *err)
{
	static const char *const reads[] = { "registered.ply", "barycentric.npz", "registration.json" };
	static const char *const writes[] = { "rig.npz", "skull.exr", "skull_normal.exr", "globe_left.exr", "globe_right.exr" };
	enum { FROM_TRANSFER = 3, IN_MAX = 32 };
	const char *dot = strrchr(file, '.');
	char *name = mem_printf("%.*s", dot ? (int)(dot - file) : (int)strlen(file), file), *in[IN_MAX], *out[OUT];
	int n = 0;
	// The surface of a character with a look is what transfer has read of its file.
	char *own = mem_printf("work/targets/%s/character.ply", name);
	in[n++] = file_exists(stage_path(stage, "%s", own)) ? mem_str(own) : mem_printf("targets/%s", file);
	free(own);
	for (int i = 0; i < FROM_TRANSFER; i++)
		in[n++] = mem_printf("work/targets/%s/%s", name, reads[i]);
	for (int i = 0; skin_model_files[i] && n < IN_MAX; i++)
		in[n++] = mem_printf("work/skin/%s", skin_model_files[i]);
	for (int i = 0; i < OUT; i++)
		out[i] = mem_printf("work/targets/%s/%s", name, writes[i]);
	bool fresh = true;
	for (int i = 0; i < OUT; i++)
		fresh = stage_fresh(stage, out[i], n, (const char *const *)in) && fresh;
	bool ok = fresh;
	if (!fresh && !file_exists(stage_path(stage, "%s", in[1])))
		stage_skipped(stage, "%s: transfer has not registered it", in[0]);
	else if (!fresh)
		ok = rig_one(why, stage, name, (const char *const *)out, n, (const char *const *)in, motion, conf, err) && !err_is(why);
	for (int i = 0; i < n; i++)
		free(in[i]);
	for (int i = 0; i < OUT; i++)
		free(out[i]);
	free(name);
	return ok;
}

bool extrapolate_targets(struct stage *stage, const struct file_list *targets, const struct rig_motion *motion,
                         const struct extrapolate_conf *conf, struct err *err)
{
	struct err *why = mem_new((size_t)targets->n + 1, sizeof *why);
	int rigged = 0, last = -1;
	for (int i = 0; i < targets->n && !err_is(err); i++) {
		if (character_kind_of(targets->names[i]) == CHARACTER_NONE)
			continue;
		rigged += target(&why[i], stage, targets->names[i], motion, conf, err);
		last = err_is(&why[i]) ? i : last;
	}
	// Where there is no other the last one is the stage's error.
	for (int i = 0; i < targets->n && !err_is(err); i++)
		if (err_is(&why[i]) && (rigged || i != last)) {
			stage_warn(stage, "%s", why[i].msg);
			stage_skipped_as_said(stage, "%s", why[i].msg);
		}
	if (!err_is(err) && !rigged && last >= 0)
		*err = why[last];
	free(why);
	return !err_is(err);
}
