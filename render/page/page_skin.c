/* The part about skin: what was tracked and learnt, and every character that is driven by it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "draw/web/base64.h"
#include "model/model.h"
#include "plan/stages.h"
#include "render/face/skin.h"
#include "render/page/page.h"

/* Clips larger than this are linked, not put into the page. */
static const size_t clip_limit = 12 << 20;

static void add(json_t *object, const char *key, json_t *value)
{
	if (value)
		json_object_set_new(object, key, value);
}

/* A file as a data: URI; beyond the limit, or not there: null. */
static json_t *data_uri(const char *path, const char *type, size_t limit)
{
	struct err err = { 0 };
	char *bytes;
	size_t size;
	if (!path || !file_read(&bytes, &size, path, limit, &err))
		return 0;
	char *head = mem_printf("data:%s;base64,", type), *uri = base64_encode(bytes, size, head);
	json_t *json = json_string_nocheck(uri);
	free(uri);
	free(head);
	free(bytes);
	return json;
}

/* The figures of a stage's log; what it left out goes into page->film. */
static json_t *facts(struct page *page, const char *stage)
{
	json_t *log = page_json(page, page_file(page, "work/log/%s.json", stage)), *list = page_facts(log);
	json_t *skips = json_object_get(log, "skipped"), *line;
	size_t i;
	json_array_foreach(skips, i, line)
		if (json_is_string(line))
			page_say(page->film, "%s: %s", stage, json_string_value(line));
	json_decref(log);
	return list;
}

static void column(struct page *page, json_t *list, const char *stage, const char *title)
{
	json_t *all = facts(page, stage);
	if (json_array_size(all))
		json_array_append_new(list, json_pack("{s:s,s:o}", "title", title, "facts", all));
	else
		json_decref(all);
}

/* Says where the fitted eye is not of the size of the character's eyeballs. */
static void check_sockets(struct page *page, const char *name)
{
	double radius[2];
	struct err none = { 0 };
	bool fitted = false;
	for (int i = 0; i < page->capture->n_eyes; i++)
		fitted = fitted || page_file(page, "%s/texture.exr", page->capture->eyes[i].iris);
	const char *rig = page_file(page, "work/targets/%s/rig.npz", name);
	char *says = fitted && rig && rig_sockets(radius, rig, &none) ? skin_socket_says(name, radius, page->conf) : 0;
	if (says)
		page_say(page->film, "%s", says);
	free(says);
}

/* What registration.json says of one character, as far as it is numbers. */
static json_t *transfer_facts(struct page *page, const char *name)
{
	json_t *root = page_json(page, page_file(page, "work/targets/%s/registration.json", name)), *list = json_array(), *value;
	const char *key;
	json_object_foreach(root, key, value)
		if (json_is_number(value))
			json_array_append_new(list, page_figure(key, json_number_value(value), 0));
	json_t *doubts = json_object_get(root, "doubtful"), *line;
	size_t i;
	json_array_foreach(doubts, i, line)
		if (json_is_string(line))
			page_say(page->film, "%s: %s", name, json_string_value(line));
	json_decref(root);
	return list;
}

static json_t *clip(struct page *page, const char *name, const char *suffix, const char *title, const char *alt)
{
	const char *path = page_file(page, "work/render/%s%s", name, suffix);
	if (!path)
		return 0;
	json_t *uri = data_uri(path, "video/mp4", clip_limit);
	if (!uri)
		uri = page_text("../render/%s%s", name, suffix);
	return json_pack("{s:s,s:s,s:o,s:o}", "title", title, "alt", alt, "uri", uri, "file", page_text("work/render/%s%s", name, suffix));
}

/* What the cells of the sheet of expressions show, in their order. */
static json_t *expressions_title(struct page *page)
{
	json_t *model = page_json(page, page_file(page, "work/skin/model.json")), *in;
	char *title = mem_str("At rest, and each expression in full");
	size_t i;
	json_array_foreach(json_object_get(model, "inputs"), i, in) {
		const char *expression = json_string_value(json_object_get(in, "name"));
		if (i < SKIN_EYE_INPUTS || !expression)
			continue;
		char *more = mem_printf("%s%s %s", title, i == SKIN_EYE_INPUTS ? ":" : ",", expression);
		free(title);
		title = more;
	}
	json_t *out = template_text(title);
	free(title);
	json_decref(model);
	return out;
}

/* Where its skin comes from, and why; null: not known. */
static json_t *skin_from(struct page *page, const char *name)
{
	json_t *told = page_json(page, page_file(page, "work/render/%s_skin.json", name));
	const char *from = json_string_value(json_object_get(told, "skin")), *why = json_string_value(json_object_get(told, "reason"));
	const bool person = from && (!strcmp(from, "video") || !strcmp(from, "views"));
	char *text = from && why ? mem_printf("%s%s%s", person ? "" : !strcmp(from, "own") ? "its own" : from, person ? "" : ": ", why) : 0;
	json_t *out = text ? page_sentence(text) : 0;
	free(text);
	json_decref(told);
	return out;
}

/* The same of its irises; null: of photographs, or not known. */
static json_t *iris_from(struct page *page, const char *name)
{
	json_t *told = page_json(page, page_file(page, "work/render/%s_skin.json", name));
	const char *why = json_string_value(json_object_get(told, "iris"));
	json_t *out = why ? page_sentence(why) : 0;
	json_decref(told);
	return out;
}

static json_t *target(struct page *page, const char *name)
{
	static const char *const stills[][3] = {
		{ "_look.png", "Looking as render.gaze says", "The character from the front" },
		{ "_sheet.png", "Nine gazes: the character looks to its right (left in the picture) .. left, up .. down", "Nine pictures of the eyes looking in nine directions" },
		{ "_blink.png", "A blink", "The left eye closing and opening" },
		{ "_expressions.png", 0, "The character's eyes at rest and with each expression" },
	};
	json_t *entry = json_object(), *pictures = json_array(), *clips = json_array();
	for (int i = 0; i < COUNT(stills); i++) {
		json_t *picture = page_picture(page, page_file(page, "work/render/%s%s", name, stills[i][0]), 2 * page->width);
		if (picture)
			json_array_append_new(pictures, json_pack("{s:o,s:s,s:o}", "title", stills[i][1] ? json_string(stills[i][1]) : expressions_title(page), "alt", stills[i][2],
			                                                "picture", picture));
	}
	json_t *registration = page_picture(page, page_file(page, "work/targets/%s/registration.png", name), 2 * page->width);
	if (registration)
		json_array_append_new(pictures, json_pack("{s:s,s:s,s:o}", "title", "Laid onto the subject; how far from it as colours", "alt",
		                                          "The subject, the character on it, one in the other", "picture", registration));
	json_t *driven = clip(page, name, "_clip.mp4", "Driven by the video", "The input video, and the character beside it");
	json_t *script = clip(page, name, "_script.mp4", "Driven by script/", "The character, moved by the script");
	if (driven)
		json_array_append_new(clips, driven);
	if (script)
		json_array_append_new(clips, script);
	struct stat st;
	const char *glb = page_file(page, "work/render/%s.glb", name);
	if (glb && !stat(glb, &st))
		add(entry, "glb", page_text("work/render/%s.glb, %.1f MB", name, (double)st.st_size / 1e6));
	add(entry, "name", template_text(name));
	add(entry, "worn", skin_from(page, name));
	add(entry, "iris", iris_from(page, name));
	add(entry, "pictures", pictures);
	add(entry, "clips", clips);
	check_sockets(page, name);
	json_t *registered = transfer_facts(page, name);
	json_object_set_new(entry, "any_registered", json_boolean(json_array_size(registered)));
	add(entry, "registered", registered);
	return entry;
}

/* Blinks of one eye: how many, and when. */
static json_t *blinks_of(const json_t *track, const char *side)
{
	enum { SHOWN = 40 };
	const double fps = json_number_value(json_object_get(track, "fps"));
	const json_t *blink;
	size_t i;
	int n = 0;
	char *when = mem_str("");
	json_array_foreach(json_object_get(track, "blinks"), i, blink) {
		const char *eye = json_string_value(json_object_get(blink, "eye"));
		if (!eye || strcmp(eye, side) || !(fps > 0))
			continue;
		const double shut = 100 * json_number_value(json_object_get(blink, "amplitude"));
		if (n++ < SHOWN) {
			char *more = mem_printf("%s%s%.2f s (%.0f %%)", when, n > 1 ? ", " : ": at ", json_number_value(json_object_get(blink, "peak")) / fps, shut);
			free(when);
			when = more;
		}
	}
	json_t *out = page_text("%d%s%s", n, when, n > SHOWN ? " ..." : "");
	free(when);
	return out;
}

/* What the video shows: the film with what was tracked on it, its course over time, blinks; null where there is no film. */
static json_t *followed(struct page *page)
{
	static const char *const names[] = { "left", "right" };
	json_t *film = clip(page, "track", ".mp4", "Gaze (orange), where the face points (white), upper and lower lids (green, blue), skin (yellow)", "The video with what was tracked drawn on it");
	json_t *course = data_uri(page_file(page, "work/render/track.svg"), "image/svg+xml", 16 << 20), *track = page_json(page, page_file(page, "work/skin/track.json"));
	json_t *out = json_object(), *facts = json_array();
	if (film)
		json_object_set_new(out, "film", film);
	if (course)
		json_object_set_new(out, "course", course);
	for (int e = 0; e < 2 && track; e++)
		json_array_append_new(facts, json_pack("{s:o,s:o}", "label", page_text("Blinks, %s eye", names[e]), "value", blinks_of(track, names[e])));
	if (track)
		json_array_append_new(facts, json_pack("{s:s,s:o}", "label", "Frames", "value", page_text("%d, %d of them lost",
			(int)json_integer_value(json_object_get(track, "frames")), (int)json_integer_value(json_object_get(track, "lost_frames")))));
	if (json_is_true(json_object_get(json_object_get(track, "camera"), "focal_assumed")))
		page_say(page->film, "track: the lens is not known: gaze is true to a few degrees, depth is not");
	json_object_set_new(out, "facts", facts);
	json_decref(track);
	return out;
}

json_t *page_skin(struct page *page)
{
	if (!page_file(page, "work/skin/model.json") && !page_file(page, "work/skin/gaze.csv"))
		return 0;
	struct file_list targets;
	struct err err = { 0 };
	json_t *skin = json_object(), *columns = json_array(), *list = json_array();
	for (int i = 0; i < PLAN_STAGES; i++)
		if (plan_stages[i].title)
			column(page, columns, plan_stages[i].name, plan_stages[i].title);
	add(skin, "columns", columns);
	add(skin, "followed", followed(page));
	json_t *model = page_json(page, page_file(page, "work/skin/model.json"));
	json_object_set_new(skin, "has_targets", json_boolean(json_integer_value(json_object_get(model, "vertices")) > 0));
	json_decref(model);
	add(skin, "track", page_picture(page, page_file(page, "work/skin/track.png"), 2 * page->width));
	add(skin, "wrinkles", page_picture(page, page_file(page, "work/skin/wrinkles.png"), 2 * page->width));
	add(skin, "curves", data_uri(page_file(page, "work/skin/curves.svg"), "image/svg+xml", 4 << 20));
	if (stage_list(page->stage, &targets, "targets", &err))
		for (int i = 0; i < targets.n; i++) {
			const char *dot = strrchr(targets.names[i], '.');
			char *name = mem_printf("%.*s", dot ? (int)(dot - targets.names[i]) : (int)strlen(targets.names[i]), targets.names[i]);
			if (page_file(page, "work/targets/%s/rig.npz", name))
				json_array_append_new(list, target(page, name));
			else
				page_say(page->missing, "targets/%s: it was not rigged.", targets.names[i]);
			free(name);
		}
	file_list_free(&targets);
	json_object_set_new(skin, "any_target", json_boolean(json_array_size(list)));
	add(skin, "targets", list);
	return skin;
}
