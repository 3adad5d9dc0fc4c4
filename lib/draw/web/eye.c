#include "draw/web/eye.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/template.h"
#include "draw/eye/colour.h"
#include "draw/eye/levels.h"
#include "draw/eye/look.h"
#include "draw/eye/march/beam.h"
#include "draw/eye/march/nodes.h"
#include "draw/eye/sclera.h"
#include "draw/web/light.h"
#include "draw/web/map.h"
#include "draw/web/picture.h"
#include "draw/web/tissue.h"
#include "limbus/record.h"
#include "optics/lightpath/path.h"

static void put(json_t *out, const char *key, int n, const double *x)
{
	json_object_set_new(out, key, n == 1 ? json_number(*x) : json_numbers(n, x));
}

/* Quadrature rules of the march: for each number of nodes and each rate of decay the nodes and weights. */
static json_t *rules(const struct scene *s)
{
	enum { RULES = 9, FADES = 25 };  // of twelve steps
	double thick[] = { scene_thickness(s, TISSUE_ABL), scene_thickness(s, TISSUE_STROMA) }, ways = LOOK_WAYS, fade[FADES];
	json_t *all = json_array();
	for (int k = 0; k < FADES; k++)
		fade[k] = SCENE_FADE_MAX * pow((double)k / (FADES - 1), 2);
	double pairs[RULES][FADES][2 * RULES];
#pragma omp parallel for collapse(2) schedule(dynamic, 4)
	for (int n = RULES; n >= 1; n--)
		for (int k = 0; k < FADES; k++) {
			double node[RULES], weight[RULES];
			scene_exponential(n, fade[k], node, weight);
			for (int i = 0; i < n; i++) {
				pairs[n - 1][k][2 * i] = node[i];
				pairs[n - 1][k][2 * i + 1] = weight[i];
			}
		}
	for (int n = 1; n <= RULES; n++) {
		json_t *of_n = json_array();
		for (int k = 0; k < FADES; k++)
			json_array_append_new(of_n, json_numbers(2 * n, pairs[n - 1][k]));
		json_array_append_new(all, of_n);
	}
	return json_pack("{s:i,s:o,s:f,s:i,s:o,s:o}", "steps", s->conf.steps, "thickness", json_numbers(2, thick), "ways", ways, "share", SCENE_SHARE, "fade",
	                 json_numbers(FADES, fade), "rules", all);
}

/* Sigma of the pupil's radius, mm, from those of its margin and of the limbus, which gives the scale; 0: not known. A radius from
 * points round an ellipse has a sigma sqrt(2) times smaller than its centre. */
static double pupil_sigma(const struct web_source *source)
{
	struct limbus_record record;
	struct err err = { 0 };
	const struct shot *shot = source->shot;
	if (!shot || !shot->fit.has_pupil || !source->edge || !file_exists(source->edge) || !limbus_record_load(&record, source->edge, &err) || !record.view.has_pupil)
		return 0;
	return source->scene->pupil[2] * hypot(record.view.pupil_sigma / M_SQRT2 / shot->fit.pupil.a, shot->fit.ellipse_sigma[2] / shot->fit.limbus.a);
}

static json_t *geometry(const struct scene *s, double gain, double sigma_of_pupil)
{
	const struct cornea *c = &s->cornea;
	json_t *out = json_object();
	double limbus[] = { s->limbus[0], s->limbus[1] }, sclera[] = { s->sclera_z, s->conf.sclera_radius, s->conf.limbus_width };
	double heights[] = { s->height_min, s->height_max }, model = s->gain;
	double tissue[] = { s->tissue_range[0], s->tissue_range[1] };
	put(out, "R", 1, &c->R);
	put(out, "p", 1, &c->p);
	put(out, "n", 1, &c->n);
	put(out, "limbus", 2, limbus);
	put(out, "sclera", 3, sclera);
	put(out, "pupil", 3, s->pupil);
	put(out, "pupil_sigma", 1, &sigma_of_pupil);
	json_object_set_new(out, "filmed", json_boolean(s->filmed));
	double own[] = { s->own_mean[0], s->own_mean[1], s->own_mean[2] };
	put(out, "own_mean", 3, own);
	double rim[] = { s->rim.width, s->rim.spread, s->rim.edge }, spread[] = { s->spread[0], s->spread[1], s->spread[2] };
	put(out, "rim", 3, rim);
	put(out, "spread", 3, spread);
	put(out, "extent", 1, &s->extent);
	put(out, "heights", 2, heights);
	put(out, "tissue_range", 2, tissue);
	put(out, "iris_depth", 1, &s->eye.iris_depth);
	put(out, "gain", 1, &model);
	put(out, "exposure", 1, &gain);
	put(out, "detail", 1, &s->conf.detail);
	double back[] = { c->R_post, c->p_post, c->thickness, c->two_surface ? c->n_cornea : 0 };
	put(out, "back", COUNT(back), back);
	json_object_set_new(out, "march", rules(s));
	json_object_set_new(out, "search", json_integer(s->conf.search));
	json_object_set_new(out, "map_px", json_integer(s->level[0].n));
	json_object_set_new(out, "levels", json_integer(s->n_levels));
	json_object_set_new(out, "marched", json_integer(scene_marched(s)));
	return out;
}

/* The photograph's own view, for the comparison beside it. */
static json_t *photo(const struct shot *shot)
{
	struct scene_view v = shot_view(shot);
	double pose[16], slip[6], camera[3] = { v.camera.focal_px, v.camera.center_px[0], v.camera.center_px[1] };
	double window[3] = { v.x0, v.y0, v.scale };
	memcpy(pose, v.cam_from_eye, sizeof pose);
	memcpy(slip, v.slip, sizeof slip);
	uint8_t *px = image_to_srgb8(&shot->image);
	json_t *out = web_picture(px, shot->image.width, shot->image.height);
	free(px);
	if (!out)
		return 0;
	put(out, "cam_from_eye", 16, pose);
	put(out, "slip", 6, slip);
	put(out, "camera", 3, camera);
	put(out, "window", 3, window);
	json_object_set_new(out, "name", template_text(shot->photo->name));
	json_object_set_new(out, "lens_bends", json_boolean(v.camera.distortion[0] != 0));
	return out;
}

/* The tint of the model's colour; of one texel, 1, where there is none. */
static json_t *tint(const struct scene *s, struct err *err)
{
	static const float none[3] = { 1, 1, 1 };
	const struct image *t = &s->tint;
	return t->px ? web_map_log(t->px, t->width, t->height, 3, SCENE_DARK, err) : web_map_log(none, 1, 1, 3, SCENE_DARK, err);
}

/* What the photograph's light did beyond the model, as a factor; of one texel, 1, where there is nothing. */
static json_t *own_light(const struct scene *s, struct err *err)
{
	const struct image *own = &s->own_light;
	int n = own->px ? own->width : 1;
	float *rgb = mem_array((size_t)n * (size_t)n, 3 * sizeof *rgb);
	for (int i = 0; i < n * n; i++)
		rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = own->px ? expf(own->px[i]) : 1;
	json_t *out = web_map_log(rgb, n, n, 3, SCENE_DARK, err);
	free(rgb);
	return out;
}

/* The parts that take long to encode, the longest first; they are encoded in parallel. */
enum part { VEINS, PHOTO, RELIEF, COLOUR, MODEL, PHOTOGRAPHED, STUDIO, WINDOW, SKY, FILM, TINT, OWN, PARTS };

/* Surroundings to choose from, coarser than the studio of the stills. */
static json_t *elsewhere(const char *name, struct envmap (*make)(int height), const struct web_source *source, struct err *err)
{
	struct envmap env = make(source->studio->map.height < 128 ? source->studio->map.height : 128);
	json_t *out = web_light(name, &env, &env, source, err);
	envmap_free(&env);
	return out;
}

/* The photograph's light, and the factor that its colour puts on pictures in it. */
static json_t *photographed(const struct shot *shot, const struct web_source *source, struct err *err)
{
	const double *w = source->scene->photo_white;
	struct envmap lamps = { 0 };
	if (shot->n_lamps)
		lamps = envmap_tinted(&shot->lamps, (double[3]){ 1 / w[0], 1 / w[1], 1 / w[2] });
	json_t *out = web_light("As photographed", &shot->env, shot->n_lamps ? &lamps : 0, source, err);
	json_object_set_new(out, "white", json_numbers(3, w));
	envmap_free(&lamps);
	return out;
}

static json_t *part_make(enum part part, const struct web_source *source, struct err *err)
{
	const struct scene *s = source->scene;
	const struct scene_level *l = &s->level[0];
	const struct shot *shot = source->shot;
	switch (part) {
	case VEINS: return web_map_log(s->veins.px, s->veins.width, s->veins.height, 4, SCENE_DARK, err);
	case PHOTO: return shot ? photo(shot) : 0;
	case RELIEF: return web_map_relief(l, err);
	case COLOUR: return web_map_colour(l, err);
	case MODEL: return l->model ? web_map_model(s, err) : 0;
	case PHOTOGRAPHED: return shot ? photographed(shot, source, err) : 0;
	case STUDIO: return web_light("Studio", source->studio, source->studio, source, err);
	case WINDOW: return elsewhere("Window", light_window, source, err);
	case SKY: return elsewhere("Overcast sky", light_sky, source, err);
	case TINT: return tint(s, err);
	case OWN: return own_light(s, err);
	default: return web_map_plain(&s->film, err);
	}
}

static void put_parts(json_t *out, json_t *part[PARTS])
{
	json_t *lights = json_array(), *maps = json_object();
	static const char *const names[PARTS] = { [VEINS] = "veins", [RELIEF] = "relief", [COLOUR] = "colour", [MODEL] = "model", [FILM] = "film", [TINT] = "tint", [OWN] = "own" };
	for (int i = 0; i < PARTS; i++)
		if (names[i] && part[i])
			json_object_set_new(maps, names[i], part[i]);
	json_array_append_new(lights, part[STUDIO]);
	if (part[PHOTOGRAPHED]) {
		json_object_set_new(part[PHOTOGRAPHED], "photographed", json_true());
		json_array_append_new(lights, part[PHOTOGRAPHED]);
	}
	json_array_append_new(lights, part[WINDOW]);
	json_array_append_new(lights, part[SKY]);
	if (part[PHOTO])
		json_object_set_new(out, "photo", part[PHOTO]);
	json_object_set_new(out, "lights", lights);
	json_object_set_new(out, "maps", maps);
}

json_t *web_eye(const struct web_source *source, struct err *err)
{
	const struct scene *s = source->scene;
	json_t *out = json_object(), *part[PARTS];
	struct err errs[PARTS] = { 0 };
	json_object_set_new(out, "side", template_text(source->side));
	json_object_set_new(out, "constants", json_pack("{s:f,s:f,s:f,s:f,s:f,s:i,s:i,s:i,s:o}", "own_width", s->conf.own_width, "ratio_most", s->conf.ratio_most, "ratio_chroma", s->conf.ratio_chroma, "sclera_reach", SCENE_SCLERA_REACH, "path_bend", path_bend(M_SQRT2), "grid", SCENE_GRID, "coarse", SCENE_COARSE, "beside", SCENE_BESIDE, "wet_lobe", json_numbers(4, envmap_wet_lobe)));
	json_object_set_new(out, "eye", geometry(s, source->gain, pupil_sigma(source)));
	json_object_set_new(out, "tissue", web_tissue(source));
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < PARTS; i++)
		part[i] = part_make((enum part)i, source, &errs[i]);
	put_parts(out, part);
	for (int i = 0; i < PARTS; i++)
		if (err_is(&errs[i])) {
			*err = errs[i];
			json_decref(out);
			return 0;
		}
	return out;
}
