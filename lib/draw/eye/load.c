/* A scene from the artifacts of one eye. */
#include <math.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/eye/fill.h"
#include "draw/eye/levels.h"
#include "draw/eye/make.h"
#include "draw/eye/march/nodes.h"
#include "draw/eye/march/paths.h"
#include "draw/eye/sclera.h"
#include "draw/eye/tint.h"
#include "image/exr.h"
#include "iris/refraction_file.h"
#include "tissue/spread.h"

static const long limit_px = 1L << 27;

/* Reads channels of a square EXR map; *extent: its half-width, mm. Values that are not finite become 0 and are counted. image_free. */
static bool read_map(struct image *out, struct scene *s, const char *path, int channels, const char *const names[], double *extent,
                     struct err *err)
{
	struct exr_info info = { 0 };
	if (!exr_read(out, path, channels, names, limit_px, &info, err))
		return false;
	*extent = info.extent_mm;
	if (out->width != out->height || !(info.extent_mm > 0)) {
		image_free(out);
		return err_set(err, "%s: an iris map is square and says its extentMm", path);
	}
	for (long i = 0; i < (long)out->width * out->height * channels; i++)
		if (!isfinite(out->px[i])) {
			out->px[i] = 0;
			s->not_finite++;
		}
	return true;
}

static bool resample(struct image *map, int n, struct err *err)
{
	if (map->width == n)
		return true;
	struct image out = image_new(n, n, map->channels);
	bool ok = cv_resize(out.px, n, n, map->px, map->width, map->height, map->channels, err);
	image_free(map);
	*map = out;
	return ok;
}

static bool load_colour(struct scene *s, const char *path, int most, struct err *err)
{
	static const char *const names[] = { "R", "G", "B", "W" };
	struct image map;
	if (!read_map(&map, s, path, 4, names, &s->extent, err))
		return false;
	int n = map.width < most ? map.width : most;
	bool ok = resample(&map, n, err);
	s->level[0] = (struct scene_level){ .n = n, .per_mm = (float)(n / (2 * s->extent)), .colour = map.px };
	return ok;
}

/* Takes the photographs' light and exposure off their colours. */
static bool balance(struct scene *s, const char *pigment, struct err *err)
{
	struct scene_level *l = &s->level[0];
	struct scene_white white;
	if (!scene_white(&white, pigment, err))
		return false;
	for (int c = 0; c < 3; c++)
		s->photo_white[c] = white.rgb[c];
	for (long i = 0; i < (long)l->n * l->n; i++)
		for (int c = 0; c < 3; c++)
			l->colour[4 * i + c] /= (float)white.rgb[c];
	return true;
}

static bool load_relief(struct scene *s, const char *path, struct err *err)
{
	struct scene_level *l = &s->level[0];
	static const char *const names[] = { "Y", "T" };
	double extent = s->extent;
	struct image map = { 0 };
	if (path && file_exists(path)) {
		if (!read_map(&map, s, path, 2, names, &extent, err))
			return false;
		if (fabs(extent - s->extent) > 1e-3 * s->extent) {
			image_free(&map);
			return err_set(err, "%s: extentMm = %g, but the texture's is %g", path, extent, s->extent);
		}
		if (!resample(&map, l->n, err)) {
			image_free(&map);
			return false;
		}
	} else {
		map = image_new(l->n, l->n, 2);
		for (long i = 0; i < (long)l->n * l->n; i++)
			map.px[2 * i + 1] = (float)scene_plain_stroma;
	}
	for (long i = 0; i < (long)l->n * l->n; i++) {  // beyond these bounds it is no relief, and the march relies on them
		map.px[2 * i] = fmaxf(-0.6f, fminf(0.6f, map.px[2 * i]));
		map.px[2 * i + 1] = fmaxf(0.02f, fminf(1, map.px[2 * i + 1]));
	}
	l->relief = map.px;
	return true;
}

static void load_pupil(struct scene *s, const char *path)
{
	struct err err = { 0 };
	json_t *root = path && file_exists(path) ? json_read(path, 1 << 22, &err) : 0, *p = json_object_get(root, "pupil");
	double v[3];
	s->pupil[2] = 1.8;  // mm: where it was not found
	if (p && json_get(&v[0], p, "cx", path, &err) && json_get(&v[1], p, "cy", path, &err) && json_get(&v[2], p, "r", path, &err)) {
		if (v[2] > 0.3 && v[2] < s->limbus[1] && hypot(v[0], v[1]) < 2)
			for (int i = 0; i < 3; i++)
				s->pupil[i] = v[i];
		else
			s->odd_pupil = v[2];
	}
	json_decref(root);
}

static bool load_tissue(struct scene *s, const char *path, struct err *err)
{
	struct tissue tissue = scene_plain_tissue;
	char reason[256];
	if (path && file_exists(path) && !tissue_without(reason, path) && !tissue_load(&tissue, path, err))
		return false;
	scene_set_tissue(s, &tissue);
	return true;
}

/* The march knows nothing of light that walks sideways in the tissue, and would show relief sharper than it looks: it takes one that is as soft. */
static bool soften_relief(struct scene *s, struct err *err)
{
	struct scene_level *l = &s->level[0];
	double sigma = tissue_spread(&s->tissue, TISSUE_SPREAD_NM, scene_plain_stroma);
	return !(sigma > 0) || tissue_spread_map(l->relief, l->n, 2, sigma * (double)l->per_mm, err);
}

/* Used only when it was made for this very cornea: the folder may have been changed since. */
static bool load_refraction(struct scene *s, const char *path, struct err *err)
{
	if (!path || !file_exists(path))
		return true;
	if (!refraction_load(&s->refraction, path, err))
		return false;
	const struct cornea *a = &s->refraction.cornea, *b = &s->cornea;
	bool same = fabs(a->R - b->R) + fabs(a->p - b->p) + fabs(a->n - b->n) < 1e-6;
	if (!same || s->refraction.method > REFRACTION_POLYNOMIAL) {  // a table is for the iris plane alone
		refraction_free(&s->refraction);
		s->refraction = (struct refraction){ 0 };
	}
	return true;
}

bool scene_load(struct scene *s, const struct scene_files *files, const struct eye *eye, const struct scene_conf *conf,
                struct err *err)
{
	*s = (struct scene){ .eye = *eye, .conf = *conf, .gain = 1, .photo_white = { 1, 1, 1 } };
	scene_geometry(s);
	load_pupil(s, files->texture_json);
	if (!load_colour(s, files->texture, conf->map_size, err) || !balance(s, files->pigment, err) || !load_relief(s, files->relief, err)
	    || !load_tissue(s, files->pigment, err) || !soften_relief(s, err) || !load_refraction(s, files->refraction, err)) {
		scene_free(s);
		return false;
	}
	scene_fill(s->level[0].colour, s->level[0].n, s->extent, s->pupil);
	scene_levels_make(s);
	if (!scene_tint_make(s, files->pigment, err)) {
		scene_free(s);
		return false;
	}
	scene_nodes_make(s);
	scene_rim_make(s);
	scene_veins_make(s);
	s->paths = scene_paths_make(s);
	return true;
}

void scene_free(struct scene *s)
{
	for (int i = 0; i < SCENE_LEVELS; i++) {
		free(s->level[i].relief);
		free(s->level[i].colour);
		free(s->level[i].model);
		free(s->level[i].per_model);
		free(s->level[i].horizon);
		free(s->level[i].pairs);
		free(s->level[i].bottom);
		free(s->level[i].shown.px);
		free(s->level[i].bare.px);
	}
	image_free(&s->veins);
	free(s->white.px);
	image_free(&s->film);
	image_free(&s->tint);
	image_free(&s->own_light);
	free(s->paths);
	refraction_free(&s->refraction);
	*s = (struct scene){ 0 };
}
