#include "freckles.h"

#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"

enum { IN = 2, OUT = 3, JSON_LIMIT = 1 << 20 };

/* The texture and what texture.json says of it. */
struct input {
	struct image rgbw;
	double extent;
	struct circle pupil;
	double white;  // ln R/G of white in it; 0 where it is not known
};

/* Of the photograph that gave the texture its colour. */
static double white_of(const json_t *texture)
{
	size_t i;
	json_t *photo;
	json_array_foreach(json_object_get(texture, "photos"), i, photo) {
		double correlation, rgb[3];
		struct err none = { 0 };
		if (json_get(&correlation, photo, "correlation", "", &none) && correlation == 1
		    && json_get_array(rgb, 3, json_object_get(photo, "white"), "rgb", "", &none) && rgb[0] > 0 && rgb[1] > 0)
			return log(rgb[0] / rgb[1]);
	}
	return 0;
}

static bool load(struct input *in, struct stage *stage, const char *const paths[IN], struct err *err)
{
	static const char *const channels[] = { "R", "G", "B", "W" };
	const long limit_px = 1L << 27;
	struct exr_info info = { 0 };
	json_t *json = json_read(stage_path(stage, "%s", paths[1]), JSON_LIMIT, err);
	if (!json)
		return false;
	const json_t *pupil = json_object_get(json, "pupil");
	bool ok = json_get(&in->pupil.cx, pupil, "cx", paths[1], err) && json_get(&in->pupil.cy, pupil, "cy", paths[1], err)
	          && json_get(&in->pupil.r, pupil, "r", paths[1], err)
	          && exr_read(&in->rgbw, stage_path(stage, "%s", paths[0]), COUNT(channels), channels, limit_px, &info, err);
	in->white = white_of(json);
	json_decref(json);
	in->extent = info.extent_mm;
	if (ok && !(in->rgbw.width == in->rgbw.height && in->extent > 0 && in->pupil.r > 0))
		return err_set(err, "%s: must be square, with extentMm and a pupil", paths[0]);
	return ok;
}

static bool save_json(const char *path, const struct freckles *found, const char *made_by, struct err *err)
{
	json_t *json = json_object(), *regions = json_array();
	double area = 0;
	for (int i = 0; i < found->n; i++) {
		const struct freckle *f = &found->items[i];
		json_array_append_new(regions, json_pack("{s:f,s:f,s:f,s:f}", "x_mm", f->x, "y_mm", f->y, "area_mm2", f->area,
		                                         "confidence", f->confidence));
		area += f->area;
	}
	json_object_set_new(json, "area_mm2", json_number(area));
	json_object_set_new(json, "regions", regions);
	bool ok = json_write(path, json, made_by, err);
	json_decref(json);
	return ok;
}

static bool save(struct stage *stage, const struct input *in, const struct freckles *found, const char *const ins[IN],
                 const char *const outs[OUT], struct err *err)
{
	static const char *const y[] = { "Y" }, *const rgbw[] = { "R", "G", "B", "W" };
	const char *made_by = stage_made_by(stage, IN, ins);
	struct exr_info info = { in->extent, made_by };
	struct image opacity = { found->size, found->size, 1, found->opacity };
	bool ok = exr_write(stage_path(stage, "%s", outs[0]), &opacity, y, EXR_HALF, &info, err)
	          && save_json(stage_path(stage, "%s", outs[1]), found, made_by, err)
	          && exr_write(stage_path(stage, "%s", outs[2]), &in->rgbw, rgbw, EXR_HALF, &info, err);
	for (int i = 0; ok && i < OUT; i++)
		ok = stage_made(stage, outs[i], IN, ins, err);
	return ok;
}

static void tell(struct stage *stage, const char *iris, const struct freckles *found)
{
	double area = 0, least = 1;
	for (int i = 0; i < found->n; i++) {
		area += found->items[i].area;
		least = fmin(least, found->items[i].confidence);
	}
	stage_figure(stage, "freckles", found->n, "");
	stage_figure(stage, "freckled area", area, "mm2");
	if (found->n) {
		stage_figure(stage, "least confidence", least, "");
		stage_note(stage, "%s: %d freckle%s, %.3f mm2 painted over", iris, found->n, found->n == 1 ? "" : "s", area);
	} else {
		stage_skipped(stage, "%s: no freckle, nothing to paint over", iris);
		stage_note(stage, "%s: no freckle", iris);
	}
}

static bool make(struct stage *stage, const char *iris, const struct eye *eye, const struct freckle_conf *conf,
                 const char *const ins[IN], const char *const outs[OUT], struct err *err)
{
	struct input in = { 0 };
	struct freckles found = { 0 };
	bool ok = load(&in, stage, ins, err);
	if (ok) {
		struct freckle_conf lit = *conf;
		lit.brown += in.white;  // in tungsten light every iris is red
		found = freckles_find(&in.rgbw, in.extent, &in.pupil, eye->limbus_radius, &lit);
		if (found.n) {
			uint8_t *mask = freckle_mask(&found, in.extent, conf->blur);
			freckle_fill(&in.rgbw, mask, in.extent, &in.pupil, eye->limbus_radius, conf);
			free(mask);
		}
		ok = save(stage, &in, &found, ins, outs, err);
	}
	if (ok)
		tell(stage, iris, &found);
	freckles_free(&found);
	image_free(&in.rgbw);
	return ok;
}

bool freckles_eye(struct stage *stage, const struct capture_eye *which, const struct eye *eye,
                  const struct freckle_conf *conf, struct err *err)
{
	static const char *const in_names[IN] = { "texture.exr", "texture.json" };
	static const char *const out_names[OUT] = { "freckles.exr", "freckles.json", "clean.exr" };
	char *ins[IN], *outs[OUT];
	for (int i = 0; i < IN; i++)
		ins[i] = mem_printf("%s/%s", which->iris, in_names[i]);
	bool fresh = true, ok = true;
	for (int i = 0; i < OUT; i++) {
		outs[i] = mem_printf("%s/%s", which->iris, out_names[i]);
		fresh &= stage_fresh(stage, outs[i], IN, (const char *const *)ins);
	}
	if (!fresh)
		ok = make(stage, which->iris, eye, conf, (const char *const *)ins, (const char *const *)outs, err);
	for (int i = 0; i < IN; i++)
		free(ins[i]);
	for (int i = 0; i < OUT; i++)
		free(outs[i]);
	return ok;
}
