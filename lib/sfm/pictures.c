#include "sfm/pictures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"

enum { FILE_LIMIT = 64 << 20 };

void pictures_load(struct pictures *known, const char *path)
{
	struct err none = { 0 };
	json_t *json = file_exists(path) ? json_read(path, FILE_LIMIT, &none) : 0;
	known->all = json_incref(json_object_get(json, "pictures"));
	known->cameras = json_incref(json_object_get(json, "cameras"));
	json_decref(json);
	if (!json_is_object(known->all) || !json_is_array(known->cameras)) {
		pictures_free(known);
		known->all = json_object();
		known->cameras = json_array();
	}
}

void pictures_free(struct pictures *known)
{
	json_decref(known->all);
	json_decref(known->cameras);
}

static int whole(const json_t *j, const char *key, int most)
{
	json_int_t v = json_integer_value(json_object_get(j, key));
	return v > 0 && v <= most ? (int)v : 0;
}

void pictures_recall(struct views *views, const struct pictures *known)
{
	for (int i = 0; i < views->n; i++) {
		struct view *v = &views->v[i];
		const json_t *j = json_object_get(known->all, v->picture), *focal = json_object_get(j, "focal_px");
		const json_t *thumb = json_object_get(j, "thumb");
		const char *maker = json_string_value(json_object_get(j, "maker"));
		if (*v->reason || !j || !maker || json_array_size(thumb) != sizeof v->thumb)
			continue;
		v->width = whole(j, "width", 1000000);
		v->height = whole(j, "height", 1000000);
		v->picture_width = whole(j, "picture_width", v->width);
		v->picture_height = whole(j, "picture_height", v->height);
		v->focal_px = json_is_number(focal) ? json_number_value(focal) : NAN;
		v->sharpness = json_number_value(json_object_get(j, "sharpness"));
		snprintf(v->maker, sizeof v->maker, "%s", maker);
		for (size_t k = 0; k < sizeof v->thumb; k++)
			v->thumb[k] = (uint8_t)json_integer_value(json_array_get(thumb, k));
	}
}

static json_t *picture_json(const struct view *v)
{
	json_t *thumb = json_array();
	for (size_t k = 0; k < sizeof v->thumb; k++)
		json_array_append_new(thumb, json_integer(v->thumb[k]));
	return json_pack("{s:i,s:i,s:i,s:i,s:o,s:f,s:s,s:o}", "width", v->width, "height", v->height, "picture_width",
	                 v->picture_width, "picture_height", v->picture_height, "focal_px", json_number(v->focal_px), "sharpness",
	                 v->sharpness, "maker", v->maker, "thumb", thumb);
}

bool pictures_save(const struct views *views, struct pictures *known, const char *path, struct err *err)
{
	json_t *all = json_object();
	for (int i = 0; i < views->n; i++)
		if (views->v[i].picture_width)
			json_object_set_new(all, views->v[i].picture, picture_json(&views->v[i]));
	json_t *json = json_pack("{s:O,s:o}", "cameras", known->cameras, "pictures", all);
	bool ok = json_write(path, json, 0, err);
	json_decref(json);
	return ok;
}

/* The number of the camera of that key; a new one is appended. */
static int camera_number(struct pictures *known, const char *key)
{
	size_t n = json_array_size(known->cameras);
	for (size_t i = 0; i < n; i++) {
		const char *k = json_string_value(json_array_get(known->cameras, i));
		if (k && !strcmp(k, key))
			return (int)i;
	}
	json_array_append_new(known->cameras, json_string(key));
	return (int)n;
}

/* Initial parameters in COLMAP's order: no distortion, principal point in the middle of the picture. */
static struct colmap_camera first_guess(const struct view *v, int number, double focal, const struct calibrate_options *o)
{
	static const enum colmap_kind lenses[] = { COLMAP_SIMPLE_RADIAL, COLMAP_RADIAL, COLMAP_OPENCV };
	struct colmap_camera c = { (uint32_t)number + 1, lenses[o->lens], v->picture_width, v->picture_height, { focal } };
	int at = c.kind == COLMAP_OPENCV ? 2 : 1;
	c.params[at - 1] = focal;
	c.params[at] = 0.5 * v->picture_width;
	c.params[at + 1] = 0.5 * v->picture_height;
	return c;
}

void pictures_cameras(struct views *views, struct pictures *known, const struct calibrate_options *o)
{
	// COLMAP's own initial guess: a focal length of 1.2 times the longer side, as of common lenses.
	const double guess = 1.2;
	for (int i = 0; i < views->n_used; i++) {
		struct view *v = &views->v[i];
		double focal = view_focal_known(v, o), scale = (double)v->picture_width / v->width;
		bool has = isfinite(focal);
		focal = has ? focal * scale : guess * fmax(v->picture_width, v->picture_height);
		char *key = mem_printf("%s %dx%d of %dx%d, %.1f px%s, lens %d", v->maker, v->picture_width, v->picture_height, v->width,
		                       v->height, focal, has ? "" : " guessed", o->lens);
		v->camera = camera_number(known, key);
		free(key);
		if (v->camera >= views->n_cameras) {
			int n = v->camera + 1;
			views->cameras = mem_grow(views->cameras, (size_t)n, sizeof *views->cameras);
			views->has_focal = mem_grow(views->has_focal, (size_t)n, sizeof *views->has_focal);
			// Numbers between belong to cameras of views that are gone: their values do not matter.
			for (int k = views->n_cameras; k < n; k++) {
				views->cameras[k] = first_guess(v, k, focal, o);
				views->has_focal[k] = has;
			}
			views->n_cameras = n;
		}
		views->cameras[v->camera] = first_guess(v, v->camera, focal, o);
		views->has_focal[v->camera] = has;
	}
}
