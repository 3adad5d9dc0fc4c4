#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "iris/unrefract/register.h"

static const double deg = M_PI / 180;

/* The photograph's white, before any gain; null where none was found. */
static json_t *white_json(const struct balance *white)
{
	if (!white->found)
		return json_null();
	json_t *json = json_object();
	json_object_set_new(json, "rgb", json_numbers(3, white->rgb));
	json_object_set_new(json, "kelvin", json_number(balance_kelvin(white->rgb)));
	json_object_set_new(json, "share", json_number(white->share));
	json_object_set_new(json, "spread", json_number(white->spread));
	return json;
}

/* What lids left of the light, red, green, blue, [3][UNREFRACT_LIDS][UNREFRACT_LIDS] of the map's square, to a thousandth. */
static void put_lids(json_t *json, const struct unrefract_view *view)
{
	enum { N = UNREFRACT_LIDS };
	const struct unrefract_survey *s = &view->survey;
	const double mm = 2 * s->extent / N;
	double to_own[2][3];
	memcpy(to_own, view->iris.a, sizeof to_own);
	double *v = mem_array(3 * N * N, sizeof *v);
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < N * N; i++) {
			double p[2];
			affine_apply(p, (const double(*)[3])to_own, (i % N + 0.5) * mm - s->extent, (i / N + 0.5) * mm - s->extent);
			const double left = exp((double)survey_at(s, s->shade + (long)c * s->size * s->size, p));
			v[c * N * N + i] = round(1000 * fmin(left, 1)) / 1000;
		}
	json_object_set_new(json, "lid_light", json_numbers(3 * N * N, v));
	json_object_set_new(json, "lid_light_extent_mm", json_number(s->extent));
	free(v);
}

static json_t *view_json(const struct unrefract_view *view)
{
	json_t *json = json_object();
	json_object_set_new(json, "name", json_string(view->name));
	json_object_set_new(json, "white", white_json(&view->white));
	json_object_set_new(json, "grey", json_boolean(view->grey));
	json_object_set_new(json, "used", json_boolean(view->used));
	if (!view->used) {
		json_object_set_new(json, "reason", json_string(view->note));
		return json;
	}
	double gain[3] = { view->gain[0], view->gain[1], view->gain[2] };
	json_object_set_new(json, "rotation_deg", json_number(view->rotation / deg));
	json_object_set_new(json, "photo_from_map", json_numbers(6, &view->iris.a[0][0]));
	json_object_set_new(json, "gain", json_numbers(3, gain));
	json_object_set_new(json, "correlation", json_number(view->correlation));
	json_object_set_new(json, "px_per_mm", json_number(iris_view_px_per_mm(&view->iris)));
	json_object_set_new(json, "lid_share", json_number(view->survey.lid_share));
	json_object_set_new(json, "glint_share", json_number(view->survey.glint_share));
	json_object_set_new(json, "lid_shade", json_number(view->survey.lid_shade));
	if (view->survey.shade)
		put_lids(json, view);
	return json;
}

/* What would make the next capture better. */
static json_t *advice(const struct unrefract_texture *texture, int n, const struct unrefract_view views[])
{
	json_t *list = json_array();
	double lid = 1, glint = 1, fine = 0, tilt = 10;
	for (int i = 0; i < n; i++)
		if (views[i].used) {
			lid = fmin(lid, views[i].survey.lid_share);
			glint = fmin(glint, views[i].survey.glint_share);
			fine = fmax(fine, iris_view_px_per_mm(&views[i].iris));
			tilt = fmin(tilt, views[i].fit->theta);
		}
	if (texture->seen < 0.9 && lid > 0.03)
		json_array_append_new(list, json_string("Lids or lashes hide part of the iris: open the eye wide, or lift the "
		                                        "upper lid, or add a photograph from another side."));
	if (glint > 0.02)
		json_array_append_new(list, json_string("Reflections cover part of the iris: cross-polarise, move the light "
		                                        "to the side, or add a photograph with the light elsewhere."));
	if (fine < 40)
		json_array_append_new(list, json_string("The iris is small in the photograph: move closer or use a longer "
		                                        "lens, so that it spans 800 pixels or more."));
	if (texture->pupil_sigma > 0)
		json_array_append_new(list, json_string("The pupil's margin does not show, and its size is a guess: light the iris from the side, "
		                                        "with no reflection over the pupil."));
	if (tilt > 30 * deg)
		json_array_append_new(list, json_string("The eye is seen from the side only: add a photograph from the front."));
	return list;
}

bool unrefract_save_json(const char *path, const struct unrefract_texture *texture, int n,
                         const struct unrefract_view views[], const char *made_by, struct err *err)
{
	json_t *json = json_object(), *photos = json_array();
	json_object_set_new(json, "size", json_integer(texture->rgbw.width));
	json_object_set_new(json, "extent_mm", json_number(texture->extent));
	json_object_set_new(json, "texels_per_mm", json_number(texture->rgbw.width / (2 * texture->extent)));
	json_object_set_new(json, "pupil", json_pack("{s:f,s:f,s:f,s:b,s:f}", "cx", texture->pupil.cx, "cy", texture->pupil.cy, "r", texture->pupil.r,
	                                             "measured", !(texture->pupil_sigma > 0), "r_sigma", texture->pupil.r * texture->pupil_sigma));
	json_object_set_new(json, "seen", json_number(texture->seen));
	bool colour = false;
	for (int i = 0; i < n; i++) {
		json_array_append_new(photos, view_json(&views[i]));
		colour |= views[i].used && !views[i].grey;
	}
	json_object_set_new(json, "colour", json_boolean(colour));
	json_object_set_new(json, "photos", photos);
	json_object_set_new(json, "photograph_better", advice(texture, n, views));
	bool ok = json_write(path, json, made_by, err);
	json_decref(json);
	return ok;
}
