#include "render/page/index.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/version.h"
#include "plan/stages.h"
#include "render/page/embed.h"

static const char *const out = "work/review/index.html";

struct inputs {
	char **rel;
	int n;
};

__attribute__((format(printf, 2, 3)))
static void add(struct inputs *in, const char *fmt, ...)
{
	va_list ap;
	char *rel;
	va_start(ap, fmt);
	rel = vasprintf(&rel, fmt, ap) < 0 ? mem_str("") : rel;
	va_end(ap);
	in->rel = mem_grow(in->rel, (size_t)in->n + 1, sizeof *in->rel);
	in->rel[in->n++] = rel;
}

/* All files that the page may show, missing ones, too: the page changes when one appears. */
static struct inputs inputs(const struct capture *capture, const struct file_list *targets)
{
	static const char *const iris[] = { "texture.exr", "texture.json", "freckles.exr", "freckles.json", "thickness.exr",
		                                "relief.exr", "pigment.json" };
	static const char *const pictures[] = { "front", "three_quarter", "turntable", "contact_sheet" };
	struct inputs in = { 0 };
	add(&in, "work/plan.json");
	add(&in, "work/calibrate/rig.png");
	add(&in, "work/review/viewer.html");
	for (int i = 1; i < PLAN_STAGES - 1; i++)  // plan keeps no log; render's own is being written
		add(&in, "work/log/%s.json", plan_stages[i].name);
	for (int e = 0; e < capture->n_eyes; e++) {
		for (int i = 0; i < COUNT(iris); i++)
			add(&in, "%s/%s", capture->eyes[e].iris, iris[i]);
		for (int i = 0; i < COUNT(pictures); i++)
			add(&in, "%s/%s.png", capture->eyes[e].render, pictures[i]);
		add(&in, "%s/eye.json", capture->eyes[e].leaves);
	}
	for (int i = 0; i < capture->n_photos; i++) {
		const struct capture_photo *p = &capture->photos[i];
		add(&in, "%s", p->file);
		add(&in, "%s", p->fit);
		add(&in, "%s/%s_compare.png", capture->eyes[p->eye].render, p->name);
		add(&in, "%s/%s_compare.json", capture->eyes[p->eye].render, p->name);
	}
	static const char *const skin[] = { "gaze.csv", "track.json", "model.json", "track.png", "wrinkles.png", "curves.svg" };
	static const char *const driven[] = { "_look.png", "_sheet.png", "_blink.png", "_expressions.png", "_skin.json", "_clip.mp4", "_script.mp4", ".glb" };
	for (int i = 0; i < COUNT(skin); i++)
		add(&in, "work/skin/%s", skin[i]);
	add(&in, "work/render/track.mp4");
	add(&in, "work/render/track.svg");
	for (int t = 0; t < targets->n; t++) {
		const char *name = targets->names[t], *dot = strrchr(name, '.');
		int n = dot ? (int)(dot - name) : (int)strlen(name);
		for (int i = 0; i < COUNT(driven); i++)
			add(&in, "work/render/%.*s%s", n, name, driven[i]);
		add(&in, "work/targets/%.*s/rig.npz", n, name);
		add(&in, "work/targets/%.*s/registration.json", n, name);
		add(&in, "work/targets/%.*s/registration.png", n, name);
	}
	return in;
}

static json_t *data_make(struct page *page)
{
	double seconds;
	char *full = realpath(page->stage->capture, 0);
	const char *base = full && strrchr(full, '/') ? strrchr(full, '/') + 1 : "capture";
	json_t *data = json_object(), *stages = page_stages(page, &seconds);
	json_object_set_new(data, "title", template_text(*base ? base : "capture"));
	json_object_set_new(data, "version", json_string(EYEWRIGHT_VERSION));
	json_object_set_new(data, "css", json_string(page_css));
	json_object_set_new(data, "js", json_string(page_js));
	json_object_set_new(data, "photos", page_photos(page));
	json_object_set_new(data, "has_photos", json_boolean(page->capture->n_photos));
	if (page->capture->n_photos)
		json_object_set_new(data, "eyes", page_eyes(page));
	json_t *rig = page_rig(page);
	if (rig)
		json_object_set_new(data, "rig", rig);
	json_t *skin = page_skin(page);
	if (skin)
		json_object_set_new(data, "skin", skin);
	json_object_set_new(data, "stages", stages);
	json_object_set_new(data, "total_seconds", page_text("%.1f", seconds));
	int n = page->capture->n_photos;
	json_object_set_new(data, "n_photos", n ? page_text("%d photograph%s, ", n, n == 1 ? "" : "s") : json_string(""));
	json_object_set(data, "advice", page->advice);
	json_object_set(data, "film", page->film);
	json_object_set(data, "missing", page->missing);
	free(full);
	return data;
}

bool page_begin(struct page_work *work, struct stage *stage, const struct capture *capture, const struct render_conf *conf, struct err *err)
{
	struct file_list targets;
	*work = (struct page_work){ .page = { stage, capture, conf, conf->page_px, json_array(), json_array(), json_array() } };
	if (!stage_list(stage, &targets, "targets", err))
		return false;
	struct inputs in = inputs(capture, &targets);
	file_list_free(&targets);
	work->in = in.rel;
	work->n_in = in.n;
	if (!stage_fresh(stage, out, in.n, (const char *const *)in.rel))
		work->data = data_make(&work->page);
	return true;
}

static bool write(struct page_work *work, struct err *err)
{
	struct stage *stage = work->page.stage;
	char *html;
	size_t size;
	json_object_set_new(work->data, "viewer", json_boolean(page_file(&work->page, "%s", "work/review/viewer.html")));
	bool ok = template_fill(&html, &size, page_html, work->data, err) && file_write(stage_path(stage, "%s", out), html, size, err)
	          && stage_made(stage, out, work->n_in, (const char *const *)work->in, err);
	if (ok)
		stage_note(stage, "%s, %.1f MB", stage_path(stage, "%s", out), (double)size / 1e6);
	free(ok ? html : 0);
	return ok;
}

bool page_end(struct page_work *work, struct err *err)
{
	// A page that was fresh at page_begin may be stale now: some of its files were made in between.
	if (!work->data && work->in && !stage_fresh(work->page.stage, out, work->n_in, (const char *const *)work->in))
		work->data = data_make(&work->page);
	bool ok = !work->data || write(work, err);
	json_decref(work->data);
	json_decref(work->page.advice);
	json_decref(work->page.film);
	json_decref(work->page.missing);
	for (int i = 0; i < work->n_in; i++)
		free(work->in[i]);
	free(work->in);
	return ok;
}
