/* What was fitted of each eye: its maps, its pigments, its pictures. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/page/page.h"

static void map(json_t *list, const char *title, const char *alt, json_t *picture, json_t *note)
{
	if (picture) {
		json_t *entry = json_pack("{s:s,s:s,s:o}", "title", title, "alt", alt, "picture", picture);
		if (note)
			json_object_set_new(entry, "note", note);
		json_array_append_new(list, entry);
	} else {
		json_decref(note);
	}
}

static json_t *freckle_note(struct page *page, const char *dir)
{
	json_t *root = page_json(page, page_file(page, "%s/freckles.json", dir)), *regions = json_object_get(root, "regions"), *r;
	size_t i, n = json_array_size(regions);
	double area = 0, sure = 0;
	json_array_foreach(regions, i, r) {
		area += json_number_value(json_object_get(r, "area_mm2"));
		sure += json_number_value(json_object_get(r, "confidence")) / (double)n;
	}
	json_t *note = n ? page_text("%zu found, %.2f mm² in all, mean confidence %.0f %%", n, area, 100 * sure) : page_text("none found");
	json_decref(root);
	return note;
}

static void colour_maps(struct page *page, json_t *list, const char *dir, const json_t *texture)
{
	static const char *const rgbw[] = { "R", "G", "B", "W" }, *const y[] = { "Y" };
	struct image colour, mask;
	if (!page_map(&colour, page, page_file(page, "%s/texture.exr", dir), 4, rgbw)) {
		page_say(page->missing, "%s/texture.exr: no photograph was unrefracted, so there is no iris to show.", dir);
		return;
	}
	json_t *seen = json_object_get(texture, "seen");
	map(list, "Texture", "The iris as it would look without its cornea", page_colour_map(&colour),
	    json_is_number(seen) ? page_text("%.0f %% of the iris was seen; stripes were not", 100 * json_number_value(seen)) : 0);
	if (page_map(&mask, page, page_file(page, "%s/freckles.exr", dir), 1, y)) {
		map(list, "Freckles", "The freckles outlined on the iris", page_mask_map(&mask, &colour), freckle_note(page, dir));
		image_free(&mask);
	}
	image_free(&colour);
}

static json_t *span(const double range[2])
{
	return page_text("%.0f µm (dark) to %.0f µm (light)", 1e3 * range[0], 1e3 * range[1]);
}

static void thickness_map(struct page *page, json_t *list, const char *dir)
{
	static const char *const y[] = { "Y" };
	struct image thick;
	double range[2];
	if (page_map(&thick, page, page_file(page, "%s/thickness.exr", dir), 1, y)) {
		json_t *picture = page_scalar_map(&thick, 0, range);
		map(list, "Thickness, coarse", "Thickness of the stroma as colour", picture, span(range));
		image_free(&thick);
	}
}

static void relief_maps(struct page *page, json_t *list, const char *dir)
{
	static const char *const yt[] = { "Y", "T" };
	struct image relief;
	double range[2];
	if (page_map(&relief, page, page_file(page, "%s/relief.exr", dir), 2, yt)) {
		json_t *picture = page_relief_map(&relief, range);
		map(list, "Relief", "The relief of the iris, lit from the upper left", picture,
		    page_text("heights %+.0f to %+.0f µm about the iris plane", 1e3 * range[0], 1e3 * range[1]));
		picture = page_scalar_map(&relief, 1, range);
		map(list, "Thickness, fitted", "Thickness of the stroma after the fitted filter, as colour", picture, span(range));
		image_free(&relief);
	}
}

enum { PICTURES = 4 };
static const char *const names[PICTURES][3] = {
	{ "front", "Front", "The fitted eye from the front, in a studio" },
	{ "three_quarter", "Three-quarter", "The fitted eye turned to three-quarter view" },
	{ "turntable", "Turntable", "The fitted eye turned from side to side, frame by frame" },
	{ "contact_sheet", "Contact sheet", "All renderings on one sheet" },
};

static void read_pictures(json_t *pictures[PICTURES], struct page *page, const char *dir)
{
	for (int i = 0; i < PICTURES; i++)
		pictures[i] = page_picture(page, page_file(page, "%s/%s.png", dir, names[i][0]), i >= 2 ? 2 * page->width : page->width * 5 / 4);
}

static json_t *renders(struct page *page, const char *dir, json_t *const pictures[PICTURES])
{
	json_t *list = json_array();
	for (int i = 0; i < PICTURES; i++) {
		if (pictures[i])
			json_array_append_new(list, json_pack("{s:s,s:s,s:b,s:b,s:o}", "title", names[i][1], "alt", names[i][2], "wide", i >= 2,
			                                      "folded", i == 3, "picture", pictures[i]));
		else
			page_say(page->missing, "%s/%s.png has not been rendered.", dir, names[i][0]);
	}
	return list;
}

/* What other programs get of the eye, where it was exported. */
static void leaves(json_t *eye, struct page *page, const char *dir)
{
	json_t *says = page_json(page, page_file(page, "%s/eye.json", dir)), *file = json_array_get(json_object_get(says, "files"), 0);
	json_t *lost = json_array_get(json_object_get(says, "lost"), 1), *bytes = json_object_get(file, "bytes"), *triangles = json_object_get(file, "triangles");
	if (json_is_integer(bytes) && json_is_integer(triangles) && json_is_object(lost)) {
		json_object_set_new(eye, "leaves", page_text("%s/eye.glb, %.1f MB, %d triangles", dir, (double)json_integer_value(bytes) / 1e6, (int)json_integer_value(triangles)));
		json_object_set_new(eye, "lost", page_text("%.2f", json_number_value(json_object_get(lost, "refraction_mm_mean"))));
	}
	json_decref(says);
}

/* Maps and pictures of one eye, each read and shrunk on its own. */
static void show_eye(json_t *eye, struct page *page, const struct capture_eye *e)
{
	json_t *list = json_array(), *texture = page_json(page, page_file(page, "%s/texture.json", e->iris));
	json_t *better = json_object_get(texture, "photograph_better"), *line, *thickness = json_array(), *relief = json_array();
	json_t *pictures[PICTURES];
	size_t i;
#pragma omp parallel sections
	{
#pragma omp section
		colour_maps(page, list, e->iris, texture);
#pragma omp section
		relief_maps(page, relief, e->iris);
#pragma omp section
		read_pictures(pictures, page, e->render);
#pragma omp section
		thickness_map(page, thickness, e->iris);
	}
	json_array_extend(list, thickness);
	json_array_extend(list, relief);
	json_decref(thickness);
	json_decref(relief);
	json_array_foreach(better, i, line)
		if (json_is_string(line))
			page_say(page->advice, "%s", json_string_value(line));
	json_decref(texture);
	json_object_set_new(eye, "maps", list);
	json_object_set_new(eye, "renders", renders(page, e->render, pictures));
	leaves(eye, page, e->leaves);
}

/* Decimals that tell two digits of a standard deviation. */
static int decimals_of(double sigma)
{
	return sigma > 0 ? (int)fmin(fmax(1 - floor(log10(sigma)), 0), 6) : 2;
}

/* A row of the table of pigments: value, sigma, and a bar of both on 0..full. decimals: below 0: as the standard deviation allows. */
static void pigment_row(json_t *rows, const json_t *root, const char *layer, const char *key, const char *label, double full,
                        double unit, int decimals)
{
	json_t *entry = json_object_get(layer ? json_object_get(root, layer) : root, key);
	json_t *v = json_object_get(entry, "value"), *s = json_object_get(entry, "sigma");
	if (!json_is_number(v))
		return;
	double value = json_number_value(v), sigma = json_is_number(s) ? json_number_value(s) : 0;
	double lo = fmin(fmax((value - sigma) / full, 0), 1), hi = fmin(fmax((value + sigma) / full, 0), 1);
	decimals = decimals < 0 ? decimals_of(sigma * unit) : decimals;
	json_array_append_new(rows, json_pack("{s:s,s:o,s:o,s:f,s:f,s:f}", "label", label, "value", page_text("%.*f", decimals, value * unit), "sigma",
	                                      page_text("%.*f", decimals, sigma * unit), "at", 100 * fmin(fmax(value / full, 0), 1), "from", 100 * lo, "wide",
	                                      fmax(100 * (hi - lo), 0.6)));
}

static double value_of(const json_t *root, const char *layer, const char *key)
{
	const json_t *entry = json_object_get(layer ? json_object_get(root, layer) : root, key);
	return json_number_value(json_is_object(entry) ? json_object_get(entry, "value") : entry);
}

/* Unknowns of the pigments' fit (pigment.json) in words. */
static const struct { const char *key, *words; } unknowns[] = {
	{ "abl.melanin", "melanin of the border layer" },
	{ "abl.eumelanin_ratio", "share of eumelanin in the border layer" },
	{ "stroma.melanin", "melanin of the stroma" },
	{ "stroma.eumelanin_ratio", "share of eumelanin in the stroma" },
	{ "stroma.thickness_scale", "optical thickness of the stroma" },
	{ "exposure", "exposure" },
	{ "white.red", "red of white" },
	{ "white.blue", "blue of white" },
	{ "veil", "stray light" },
};

/* The unknowns that lie for more than half of their square in directions that priors hold. */
static json_t *held_words(const json_t *directions)
{
	json_t *list = json_array(), *entry;
	size_t i;
	for (int k = 0; k < COUNT(unknowns); k++) {
		double held = 0;
		json_array_foreach(directions, i, entry)
			held += pow(json_number_value(json_object_get(json_object_get(entry, "of"), unknowns[k].key)), 2);
		if (held > 0.5)
			json_array_append_new(list, template_text(unknowns[k].words));
	}
	return list;
}

/* How the border layer's melanin differs from the pupil to the root, in words; null where one melanin explains the colours. */
static json_t *melanin_words(const json_t *map)
{
	const json_t *rings = json_object_get(map, "rings"), *first = json_array_get(rings, 0);
	const json_t *last = json_array_size(rings) > 1 ? json_array_get(rings, json_array_size(rings) - 1) : 0;
	if (!last)
		return 0;
	const double at[2] = { json_number_value(json_object_get(first, "ln")), json_number_value(json_object_get(last, "ln")) };
	const double sigma = json_number_value(json_object_get(first, "sigma"));
	return page_text("%.2f times its mean next to the pupil (%.2f to %.2f), %.2f times at the root", exp(at[0]), exp(at[0] - sigma), exp(at[0] + sigma),
	                 exp(at[1]));
}

static json_t *pigments(struct page *page, const char *dir)
{
	json_t *root = page_json(page, page_file(page, "%s/pigment.json", dir));
	if (!root) {
		page_say(page->missing, "%s/pigment.json: no pigments were fitted.", dir);
		return 0;
	}
	const char *without = json_string_value(json_object_get(root, "without"));
	if (without) {
		page_say(page->missing, "No pigments: %s.", without);
		json_decref(root);
		return 0;
	}
	json_t *rows = json_array(), *out = json_pack("{s:o}", "rows", rows);
	double most = fmax(fmax(value_of(root, "abl", "melanin"), value_of(root, "stroma", "melanin")) * 1.6, 1e-4);
	double scale = fmax(2 * value_of(root, "stroma", "thickness_scale"), 1), exposure = fmax(2 * value_of(root, 0, "exposure"), 1);
	pigment_row(rows, root, "abl", "melanin", "Anterior border layer: melanin, % of volume", most, 100, -1);
	pigment_row(rows, root, "abl", "eumelanin_ratio", "Anterior border layer: eumelanin, % of melanin", 1, 100, 0);
	pigment_row(rows, root, "stroma", "melanin", "Stroma: melanin, % of volume", most, 100, -1);
	pigment_row(rows, root, "stroma", "eumelanin_ratio", "Stroma: eumelanin, % of melanin", 1, 100, 0);
	pigment_row(rows, root, "stroma", "thickness_scale", "Stroma: optical over anatomical thickness", scale, 1, 2);
	pigment_row(rows, root, 0, "exposure", "Exposure: photograph over model", exposure, 1, 2);
	const char *note = json_string_value(json_object_get(root, "note"));
	if (note && *note)
		json_object_set_new(out, "note", page_sentence(note));
	json_t *rgb = json_object_get(root, "residual_rgb");
	if (json_array_size(rgb) == 3)
		json_object_set_new(out, "residual", page_text("%.3f, %.3f, %.3f", json_number_value(json_array_get(rgb, 0)),
		                                               json_number_value(json_array_get(rgb, 1)),
		                                               json_number_value(json_array_get(rgb, 2))));
	json_t *map = melanin_words(json_object_get(root, "melanin_map"));
	if (map)
		json_object_set_new(out, "map", map);
	json_t *weak = held_words(json_object_get(root, "held_by_priors"));
	json_object_set_new(out, "any_held", json_boolean(json_array_size(weak)));
	json_object_set_new(out, "held", weak);
	json_decref(root);
	return out;
}

json_t *page_eyes(struct page *page)
{
	json_t *list = json_array();
	for (int i = 0; i < page->capture->n_eyes; i++) {
		const struct capture_eye *e = &page->capture->eyes[i];
		json_t *eye = json_object(), *pigment = pigments(page, e->iris);
		const char *side = strcmp(e->side, "eye") ? e->side : "";
		json_object_set_new(eye, "side", json_string(side));
		show_eye(eye, page, e);
		if (pigment)
			json_object_set_new(eye, "pigments", pigment);
		json_array_append_new(list, eye);
	}
	return list;
}
