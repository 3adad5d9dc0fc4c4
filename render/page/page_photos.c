/* The photographs with what was found in them, and each beside its rendering. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "image/photo/photo.h"
#include "render/page/page.h"

static const double deg = M_PI / 180;

static json_t *ellipse(const struct ellipse *e)
{
	return json_pack("{s:f,s:f,s:f,s:f,s:f}", "cx", e->cx, "cy", e->cy, "a", e->a, "b", e->b, "angle", e->angle / deg);
}

static void fact(json_t *facts, const char *label, json_t *value)
{
	json_array_append_new(facts, json_pack("{s:s,s:o}", "label", label, "value", value));
}

static json_t *facts(const struct fit *f)
{
	json_t *list = json_array();
	fact(list, "Tilt of the optical axis", page_text("%.2f° ± %.2f°, towards %.0f°", f->theta / deg, f->theta_sigma / deg, f->phi / deg));
	fact(list, "Iris across", page_text("%.1f × %.1f px", 2 * f->limbus.a, 2 * f->limbus.b));
	fact(list, "Centre", page_text("%.2f, %.2f px (± %.2f, ± %.2f)", f->limbus.cx, f->limbus.cy, f->ellipse_sigma[0], f->ellipse_sigma[1]));
	fact(list, "Limbus seen", page_text("%.0f %%, residual %.2f px", 100 * f->coverage, f->rms_px));
	if (f->has_pupil)
		fact(list, "Pupil across", page_text("%.1f × %.1f px", 2 * f->pupil.a, 2 * f->pupil.b));
	static const char *const sources[] = { "not known: weak perspective", "capture.conf", "EXIF", "calibrated rig" };
	fact(list, "Camera", isfinite(f->camera.focal_px) && f->camera.source != CAMERA_NONE
	                             ? page_text("focal length %.0f px, from %s", f->camera.focal_px, sources[f->camera.source])
	                             : page_text("%s", sources[CAMERA_NONE]));
	return list;
}

/* What texture.json says of a photograph; null where it says nothing. The root is the caller's: json_decref. */
static json_t *unrefracted(json_t **root, struct page *page, const char *iris, const char *name)
{
	size_t i;
	json_t *photo;
	*root = page_json(page, page_file(page, "%s/texture.json", iris));
	json_array_foreach(json_object_get(*root, "photos"), i, photo) {
		const char *is = json_string_value(json_object_get(photo, "name"));
		if (is && !strcmp(is, name) && json_is_true(json_object_get(photo, "used")))
			return photo;
	}
	return 0;
}

/* The colour of the light, and what of the iris is covered. */
static void more_facts(json_t *list, struct page *page, const char *iris, const char *name)
{
	json_t *root, *photo = unrefracted(&root, page, iris, name), *white = json_object_get(photo, "white");
	json_t *kelvin = json_object_get(white, "kelvin"), *rgb = json_object_get(white, "rgb");
	if (json_is_true(json_object_get(photo, "grey")))
		fact(list, "Light", page_text("the photograph is grey"));
	else if (json_is_number(kelvin) && json_array_size(rgb) == 3)
		fact(list, "Light", page_text("%.0f K by the sclera; white is %.2f, %.2f, %.2f", json_number_value(kelvin),
		                              json_number_value(json_array_get(rgb, 0)), json_number_value(json_array_get(rgb, 1)),
		                              json_number_value(json_array_get(rgb, 2))));
	else if (photo)
		fact(list, "Light", page_text("its colour is not known: too little sclera is seen"));
	const double shade = json_number_value(json_object_get(photo, "lid_shade"));
	if (shade > 0.01)
		fact(list, "Iris shaded", page_text("lids take %.0f %% of its light: given back", 100 * shade));
	if (photo)
		fact(list, "Iris hidden", page_text("%.0f %% by lids and lashes, %.0f %% by reflections: filled in",
		                                    100 * json_number_value(json_object_get(photo, "lid_share")),
		                                    100 * json_number_value(json_object_get(photo, "glint_share"))));
	json_decref(root);
}

static void advise(struct page *page, const char *name, const struct fit *f)
{
	if (!f->ok) {
		page_say(page->advice, "%s was not used: %s", name, f->reason);
		return;
	}
	if (f->rough > 0)
		page_say(page->advice, "%s is the best of its eye, but where the iris ends is known to %.2g %% of its radius only: %s", name, 100 * f->rough, f->reason);
	if (f->coverage < 0.6)
		page_say(page->advice, "%s: lids hide %.0f %% of the limbus. Open the eye wider, or hold the upper lid.", name,
		         100 * (1 - f->coverage));
	if (f->limbus.a < 200)
		page_say(page->advice, "%s: the iris is only %.0f px across. Go closer, or use a longer lens: 800 px and more show its fibres.",
		         name, 2 * f->limbus.a);
	if (f->camera.source == CAMERA_NONE)
		page_say(page->advice, "%s: no focal length is known. Keep the EXIF data, or set camera.focal_px: off the middle of "
		         "the picture the pose is wrong by degrees without it.", name);
	if (f->theta_sigma > 2 * deg)
		page_say(page->advice, "%s: the direction of the eye is known to ± %.1f° only. Nearly frontal views say little about "
		         "it: add photographs from 20–30° to the side.", name, f->theta_sigma / deg);
	if (f->edge_sigma_px > 0.02 * f->limbus.a && f->edge_sigma_px > 3)
		page_say(page->advice, "%s: the limbus is blurred over %.1f px. Focus on the iris, close the aperture, use a shorter exposure.",
		         name, f->edge_sigma_px);
}

static void add(json_t *object, const char *key, json_t *value)
{
	if (value)
		json_object_set_new(object, key, value);
}

static void likeness(struct page *page, json_t *entry, const char *dir, const char *name)
{
	const char *compare = page_file(page, "%s/%s_compare.png", dir, name);
	json_t *numbers = page_json(page, page_file(page, "%s/%s_compare.json", dir, name)), *like = json_object();
	json_t *panels[3];
	if (page_panels(panels, page, compare)) {
		add(like, "photo", panels[0]);
		add(like, "render", panels[1]);
		add(like, "difference", panels[2]);
		json_object_set_new(like, "name", template_text(name));
		double mean = json_number_value(json_object_get(numbers, "difference_mean"));
		double high = json_number_value(json_object_get(numbers, "difference_95"));
		double model = json_number_value(json_object_get(numbers, "model_difference_mean"));
		const char *colours = json_string_value(json_object_get(numbers, "colours_from"));
		if (mean > 0) {
			add(like, "mean", page_text("%.1f", mean));
			add(like, "high", page_text("%.1f", high));
			if (model > 0)
				add(like, "model", page_text("%.1f", model));
			if (colours && strcmp(colours, name))
				add(like, "colours", template_text(colours));
		}
		json_object_set_new(entry, "likeness", like);
	} else {
		json_decref(like);
	}
	json_decref(numbers);
}

/* Size of the upright photograph as its header says, px; false where it cannot be read. */
static bool size_of(int *width, int *height, const char *path)
{
	char *data = 0;
	size_t size = 0;
	struct err err = { 0 };
	struct photo head = { 0 };
	bool ok = path && file_read(&data, &size, path, (size_t)1 << 30, &err) && photo_header(&head, data, size, 1e5, &err);
	bool sideways = head.exif.orientation >= 5;
	*width = sideways ? head.height : head.width;
	*height = sideways ? head.width : head.height;
	free(data);
	return ok;
}

/* The likeliest ellipse of a photograph that was not used, as its fit at `path` has it. False: there is none. */
static bool likeliest(struct ellipse *e, struct page *page, const char *path)
{
	double v[5];
	struct err err = { 0 };
	json_t *root = page_json(page, path);
	const bool ok = json_is_array(json_object_get(root, "likeliest_px")) && json_get_array(v, 5, root, "likeliest_px", path, &err) && v[2] >= v[3] && v[3] > 0;
	if (ok)
		*e = (struct ellipse){ v[0], v[1], v[2], v[3], v[4] * deg };
	json_decref(root);
	return ok;
}

/* The part of the photograph that the page shows, px: all of it, or where the eye is small in it, that eye. */
static void shown_of(int box[4], const struct ellipse *e, int width, int height)
{
	const double small = 0.08, wide = 5, high = 4;  // of the longer side; semi-axes to each side
	memcpy(box, (int[]){ 0, 0, width, height }, 4 * sizeof *box);
	if (!(e->a > 0) || e->a > small * fmax(width, height))
		return;
	box[0] = (int)fmin(fmax(e->cx - wide * e->a, 0), width - 1);
	box[1] = (int)fmin(fmax(e->cy - high * e->a, 0), height - 1);
	box[2] = (int)fmin(ceil(2 * wide * e->a), width - box[0]);
	box[3] = (int)fmin(ceil(2 * high * e->a), height - box[1]);
}

/* The ellipse that is drawn, and a hand may correct: the fit's, the likeliest that was not believed, or one in the middle. False: the photograph's size
 * is not known. */
static bool drawn_of(struct ellipse *e, bool *guessed, int size[2], struct page *page, const struct fit *f, const char *path, const char *file)
{
	*e = f->limbus;
	size[0] = f->width;
	size[1] = f->height;
	if (f->ok)
		return true;
	if (!size_of(&size[0], &size[1], file))
		return false;
	*guessed = likeliest(e, page, path);
	const double r = 0.25 * fmin(size[0], size[1]);
	if (!*guessed)
		*e = (struct ellipse){ 0.5 * size[0], 0.5 * size[1], r, r, 0 };
	return true;
}

/* The photograph with the ellipse on it, for page.js. */
static void frame(json_t *entry, struct page *page, const struct capture_photo *p, const struct fit *f, const char *path, const char *file)
{
	struct ellipse e;
	bool guessed = false;
	int size[2], box[4];
	if (!drawn_of(&e, &guessed, size, page, f, path, file)) {
		add(entry, "picture", page_picture(page, file, 2 * page->width));
		return;
	}
	shown_of(box, &e, size[0], size[1]);
	const bool whole = box[2] == size[0] && box[3] == size[1];
	add(entry, "picture", whole ? page_picture(page, file, 2 * page->width) : page_picture_part(page, file, box, 2 * page->width));
	json_object_set_new(entry, "box", page_text("%d %d %d %d", box[0], box[1], box[2], box[3]));
	json_object_set_new(entry, "stroke", json_real(box[2] / 450.0));
	json_object_set_new(entry, "hand", json_pack("{s:o,s:o}", "at", ellipse(&e), "key", template_text(p->name)));
	if (guessed)
		json_object_set_new(entry, "guessed", json_true());
}

static json_t *photo(struct page *page, const struct capture_photo *p)
{
	struct err err = { 0 };
	struct fit fit;
	const char *path = page_file(page, "%s", p->fit), *file = page_file(page, "%s", p->file);
	json_t *entry = json_object();
	json_object_set_new(entry, "name", template_text(p->name));
	json_object_set_new(entry, "file", template_text(p->file));
	if (!path || !fit_load(&fit, path, &err)) {
		add(entry, "picture", page_picture(page, file, 2 * page->width));
		json_object_set_new(entry, "reason", page_sentence(path ? err.msg : "the stage limbus has not looked at it"));
		page_say(page->missing, "%s: %s", p->name, path ? err.msg : "no fit; the stage limbus has not looked at it");
		return entry;
	}
	advise(page, p->name, &fit);
	frame(entry, page, p, &fit, path, file);
	if (!fit.ok) {
		json_object_set_new(entry, "reason", page_sentence(fit.reason));
		return entry;
	}
	json_object_set_new(entry, "ok", json_true());
	json_object_set_new(entry, "limbus", ellipse(&fit.limbus));
	if (fit.rough > 0) {
		json_object_set_new(entry, "rough", page_text("%.2g", 100 * fit.rough));
		json_object_set_new(entry, "doubt", page_sentence(fit.reason));
	}
	if (fit.has_pupil)
		json_object_set_new(entry, "pupil", ellipse(&fit.pupil));
	json_t *list = facts(&fit);
	more_facts(list, page, page->capture->eyes[p->eye].iris, p->name);
	json_object_set_new(entry, "facts", list);
	likeness(page, entry, page->capture->eyes[p->eye].render, p->name);
	return entry;
}

json_t *page_photos(struct page *page)
{
	json_t *list = json_array();
	for (int i = 0; i < page->capture->n_photos; i++)
		json_array_append_new(list, photo(page, &page->capture->photos[i]));
	return list;
}
