/* The files of one eye's export: which there are, whether they are fresh, and their writing. */
#include "render/export/export.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/template.h"
#include "export/lod.h"
#include "image/exr.h"
#include "image/picture.h"
#include "render/face/skin.h"
#include "render/page/embed.h"

enum { GLBS = 1 + EXPORT_LODS, MAX_FILES = 8 + GLBS + EXPORT_VIEWS + 2 * EXPORT_MAPS };

static const double view_deg[EXPORT_VIEWS] = { 0, 30, 60 };
static const char *const glb_names[GLBS] = { "eye.glb", "eye_lod1.glb", "eye_lod2.glb" };

/* Files of an export, relative to the capture, and what they are made from. */
struct files {
	const char *rel[MAX_FILES];
	int n;
	const char *in[COUNT(((struct job *)0)->in) + 4];
	int n_in;
};

__attribute__((format(printf, 3, 4)))
static const char *add(struct files *f, struct job *job, const char *fmt, ...)
{
	va_list ap;
	char *name = 0;
	va_start(ap, fmt);
	if (vasprintf(&name, fmt, ap) < 0)
		name = mem_str("");
	va_end(ap);
	const char *rel = stage_path(job->stage, "%s/%s", job->names->leaves, name) + strlen(job->stage->capture) + 1;
	free(name);
	return f->rel[f->n++] = rel;
}

static struct files files_of(struct job *job, const struct export_conf *conf, const struct skin_target *face)
{
	struct files f = { .n_in = job->n_in };
	memcpy(f.in, job->in, sizeof job->in);
	f.in[f.n_in++] = stage_path(job->stage, "%s/freckles.exr", job->names->iris) + strlen(job->stage->capture) + 1;
	for (int i = 0; i < face->n_in; i++)
		f.in[f.n_in++] = face->in[i];
	for (int i = 0; i < GLBS; i++)
		add(&f, job, "%s", glb_names[i]);
	add(&f, job, "eye.json");
	add(&f, job, "blender_eye.py");
	add(&f, job, "engines.md");
	add(&f, job, "studio.exr");
	for (int i = 0; i < EXPORT_VIEWS; i++)
		add(&f, job, "reference_%02.0f.exr", view_deg[i]);
	for (int i = 0; i < EXPORT_MAPS; i++) {
		add(&f, job, "textures/%s.png", export_map_names[i]);
		if (conf->exr)
			add(&f, job, "textures/%s.exr", export_map_names[i]);
	}
	return f;
}

static bool load_freckles(struct image *out, struct job *job, struct err *err)
{
	const char *path = stage_path(job->stage, "%s/freckles.exr", job->names->iris);
	*out = (struct image){ 0 };
	return !file_exists(path) || exr_read(out, path, 1, (const char *const[]){ "Y" }, 1L << 26, 0, err);
}

/* The renderer's own picture from each side, and what a rasteriser would show in its place. */
static void refer(struct export_work *w)
{
	struct job *job = w->job;
	struct scene_lighting light = scene_lighting_of(&job->studio, &job->studio, job->conf->lights, job->conf->light_directions);
	for (int i = 0; i < EXPORT_VIEWS; i++) {
		struct scene_view view = scene_view_turned(&job->scene, view_deg[i] * M_PI / 180, 0, job->conf->field_mm, 512);
		view.samples = job->conf->samples;
		w->reference[i] = scene_render(&job->scene, &view, &light, &job->count);
		w->loss[i] = export_loss_of(&job->scene, w->maps, &view, &job->studio, &w->reference[i], job->gain);
		w->loss[i].deg = view_deg[i];
	}
}

/* An eye of so many rings and vertices round, its iris simplified from one of four times as many rings. Returns its triangles. */
static int coarse_eye(struct export_part parts[EXPORT_PARTS], double *error_mm, const struct scene *scene, const struct export_mesh_conf *conf)
{
	struct export_mesh_conf more = { .iris_rings = 4 * conf->iris_rings, .around = conf->around };
	struct export_part fine[EXPORT_PARTS];
	int n = 0;
	export_eye_meshes(parts, scene, conf);
	export_eye_meshes(fine, scene, &more);
	int iris = parts[EXPORT_IRIS].n_corners / 3;
	export_part_free(&parts[EXPORT_IRIS]);
	parts[EXPORT_IRIS] = export_lod(&fine[EXPORT_IRIS], iris, error_mm);
	for (int i = 0; i < EXPORT_PARTS; i++) {
		export_part_free(&fine[i]);
		n += parts[i].n_corners / 3;
	}
	return n;
}

void export_fewer(struct export_part parts[EXPORT_PARTS], double *error_mm, const struct scene *scene, const struct export_mesh_conf *conf, long all,
                  double triangles)
{
	// The border of a simplified iris stays, and a lip and a disc do not shrink with the rest: a share is a start.
	enum { LEAST_RINGS = 6, LEAST_AROUND = 24 };
	for (double share = fmin(sqrt(triangles / (double)all), 1);; share *= 0.98) {
		const int rings = (int)fmax(LEAST_RINGS, 0.5 * share * conf->iris_rings), around = (int)fmax(LEAST_AROUND, share * conf->around);
		const struct export_mesh_conf less = { .iris_rings = 2 * rings, .around = around };
		if (coarse_eye(parts, error_mm, scene, &less) <= triangles || (rings == LEAST_RINGS && around == LEAST_AROUND))
			return;
		for (int i = 0; i < EXPORT_PARTS; i++)
			export_part_free(&parts[i]);
	}
}

/* What stands on the lids of a character round this eye, where the capture has one. */
static bool take_margin(struct export_work *w, struct skin_job *faces, struct skin_target *face, struct err *err)
{
	const int side = !strcmp(w->job->names->side, "right");
	if (!face->name)
		return true;
	if (!skin_open(faces, face, err))
		return false;
	const double over = fmax(skin_over_globe(&w->job->scene, &face->rig.globe[side]), 0);
	export_margin(w->margin, &w->job->scene, &face->rig, portrait_hairs(face->portrait), side, faces->conf->portrait.tear_mm, over);
	w->has_margin = true;
	memcpy(w->hair_rgb, faces->conf->portrait.hair_rgb, sizeof w->hair_rgb);
	return true;
}

static bool write_meshes(struct export_work *w, const char *made_by, struct err *err)
{
	bool ok = true;
	long all = 0;
	for (int i = 0; i < EXPORT_PARTS; i++)
		all += w->parts[i].n_corners / 3;
	for (int k = 0; ok && k < GLBS; k++) {
		struct export_part less[EXPORT_PARTS] = { 0 };
		if (k)
			export_fewer(less, &w->error_mm[k], &w->job->scene, &w->conf->mesh, all, w->conf->lod_triangles[k - 1]);
		const struct export_part *parts = k ? less : w->parts;
		for (int i = 0; i < EXPORT_PARTS; i++) {
			w->triangles[k] += parts[i].n_corners / 3;
			w->vertices[k] += parts[i].n;
		}
		struct export_eye eye = { parts, w->pictures, w->job->scene.cornea.n, w->high[EXPORT_CORNEA_DEPTH], "eye", made_by, 2 * w->job->scene.pupil[2],
			                      w->has_margin ? w->margin : 0, { 0 } };
		memcpy(eye.hair_rgb, w->hair_rgb, sizeof eye.hair_rgb);
		ok = export_eye_glb(stage_path(w->job->stage, "%s/%s", w->job->names->leaves, glb_names[k]), &eye, &w->bytes[k], err);
		for (int i = 0; i < EXPORT_PARTS; i++)
			export_part_free(&less[i]);
	}
	return ok;
}

static bool write_texture(struct export_work *w, int i, bool exr, const char *made_by, struct err *err)
{
	static const char *const rgb[] = { "R", "G", "B" }, *const y[] = { "Y" };
	const char *path = stage_path(w->job->stage, "%s/textures/%s.%s", w->job->names->leaves, export_map_names[i], exr ? "exr" : "png");
	struct exr_info info = { .made_by = made_by };
	return exr ? exr_write(path, &w->maps[i], w->maps[i].channels == 3 ? rgb : y, EXR_HALF, &info, err)
	           : file_write(path, w->png[i].data, w->png[i].size, err);
}

static bool write_reference(struct export_work *w, int i, const char *made_by, struct err *err)
{
	static const char *const rgba[] = { "R", "G", "B", "A" };
	struct exr_info info = { .made_by = made_by };
	const char *dir = w->job->names->leaves;
	return i < EXPORT_VIEWS ? exr_write(stage_path(w->job->stage, "%s/reference_%02.0f.exr", dir, view_deg[i]), &w->reference[i], rgba, EXR_HALF, &info, err)
	                        : exr_write(stage_path(w->job->stage, "%s/studio.exr", dir), &w->job->studio.map, rgba, EXR_HALF, &info, err);
}

/* Everything that is a picture, in parallel: compression takes the time. */
static bool write_pictures(struct export_work *w, const char *made_by, struct err *err)
{
	enum { ALL = 2 * EXPORT_MAPS + EXPORT_VIEWS + 1 };
	struct err late[ALL] = { 0 };
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < ALL; i++)
		if (i >= 2 * EXPORT_MAPS)
			write_reference(w, i - 2 * EXPORT_MAPS, made_by, &late[i]);
		else if (w->conf->exr || i < EXPORT_MAPS)
			write_texture(w, i % EXPORT_MAPS, i >= EXPORT_MAPS, made_by, &late[i]);
	for (int i = 0; i < ALL && !err_is(err); i++)
		*err = late[i];
	return !err_is(err);
}

static bool write_texts(struct export_work *w, const char *made_by, struct err *err)
{
	const char *const template[] = { export_blender_py, export_engines_md }, *const names[] = { "blender_eye.py", "engines.md" };
	struct stage *stage = w->job->stage;
	json_t *says = export_statement(w);
	bool ok = json_write(stage_path(stage, "%s/eye.json", w->job->names->leaves), says, made_by, err);
	for (int i = 0; ok && i < 2; i++) {
		char *text;
		size_t size;
		ok = template_fill(&text, &size, template[i], says, err) && file_write(stage_path(stage, "%s/%s", w->job->names->leaves, names[i]), text, size, err);
		free(text);
	}
	json_decref(says);
	return ok;
}

static void tell(const struct export_work *w)
{
	struct stage *stage = w->job->stage;
	stage_note(stage, "%s/eye.glb: %d triangles, %.1f MB; a rasteriser loses %.3f mm at 0, %.3f at 30, %.3f at 60 degrees, %.1f, %.1f, %.1f of colour (CIEDE2000)",
	           w->job->names->leaves, w->triangles[0], (double)w->bytes[0] / 1e6, w->loss[0].mm_mean, w->loss[1].mm_mean, w->loss[2].mm_mean,
	           w->loss[0].de_mean, w->loss[1].de_mean, w->loss[2].de_mean);
	stage_figure(stage, "export_loss_30", w->loss[1].mm_mean, "mm on the iris, by a rasteriser's refraction at 30 degrees");
	stage_figure(stage, "export_difference_30", w->loss[1].de_mean, "CIEDE2000 on the iris, in a rasteriser at 30 degrees");
}

bool export_eye(struct job *job, const struct export_conf *conf, struct skin_job *faces, struct err *err)
{
	if (!job->usable) {
		stage_skipped_as_said(job->stage, "export of the %s eye: there is no iris to export", job->names->side);
		return true;
	}
	struct skin_target face;
	if (!skin_first(&face, job->stage, err))
		return false;
	struct files f = files_of(job, conf, &face);
	bool fresh = true;
	for (int i = 0; i < f.n; i++)
		fresh &= stage_fresh(job->stage, f.rel[i], f.n_in, f.in);
	const bool wanted = conf->make || job->stage->only;
	// One that was asked for alone stays for as long as it is of this eye.
	if (!fresh && !wanted)
		stage_skipped_as_said(job->stage, "%s/eye.glb: export.make = no: make export makes it", job->names->leaves);
	if (fresh || !wanted)
		return true;
	struct export_work w = { .job = job, .conf = conf };
	struct image freckles = { 0 };
	const char *made_by = stage_made_by(job->stage, f.n_in, f.in);
	bool ok = job_ready(job, err) && load_freckles(&freckles, job, err)
	          && export_eye_maps(w.maps, &job->scene, freckles.px ? &freckles : 0, &job->studio, conf->texture_px, err) && export_encode(&w, err);
	if (ok) {
		export_eye_meshes(w.parts, &job->scene, &conf->mesh);
		refer(&w);
		ok = take_margin(&w, faces, &face, err) && write_meshes(&w, made_by, err) && write_pictures(&w, made_by, err) && write_texts(&w, made_by, err);
	}
	for (int i = 0; ok && i < f.n; i++)
		ok = stage_made(job->stage, f.rel[i], f.n_in, f.in, err);
	if (ok)
		tell(&w);
	skin_free(&face);
	image_free(&freckles);
	export_work_free(&w);
	return ok;
}
