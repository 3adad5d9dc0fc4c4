#include "render/viewer.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/version.h"
#include "render/embed.h"
#include "render/page.h"

static const char *const out = "work/review/viewer.html";

/* JSON as the text of a script element: no "<" can end it. free(). */
static char *script_text(const json_t *json)
{
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(9)), *safe, *to;
	size_t n = 1, marks = 0;
	for (const char *s = text; *s; s++, n++)
		marks += *s == '<';
	safe = to = mem_array(n + 5 * marks, 1);
	for (const char *s = text; *s; s++) {
		if (*s == '<')
			to = stpcpy(to, "\\u003c");
		else
			*to++ = *s;
	}
	*to = 0;
	free(text);
	return safe;
}

/* How eyes move: animate's own configuration, and what this folder says instead. */
static json_t *motion(const struct stage *stage)
{
	json_t *own = json_object();
	for (int i = 0; i < stage->conf.n; i++) {
		const struct conf_item *item = &stage->conf.items[i];
		if (item->layer && !strncmp(item->key, "animate.", 8))
			json_object_set_new(own, item->key + 8, template_text(item->value));
	}
	return json_pack("{s:s,s:o}", "defaults", viewer_motion_conf, "own", own);
}

/* What a browser without WebGL 2 shows. */
static json_t *stills(struct page *page)
{
	static const char *const names[][2] = { { "front", "The fitted eye from the front" }, { "three_quarter", "The fitted eye turned" } };
	json_t *list = json_array();
	for (int e = 0; e < page->capture->n_eyes; e++)
		for (int i = 0; i < COUNT(names); i++) {
			json_t *picture = page_picture(page, page_file(page, "%s/%s.png", page->capture->eyes[e].render, names[i][0]), page->width);
			if (picture) {
				json_object_set_new(picture, "alt", json_string(names[i][1]));
				json_array_append_new(list, picture);
			}
		}
	return list;
}

static void programs(json_t *data)
{
	const struct {
		const char *key, *text;
	} part[] = { { "css", viewer_css }, { "common", viewer_common }, { "decode", viewer_decode }, { "paths", viewer_paths },
		         { "eye_frag", viewer_eye_frag }, { "present", viewer_present } };
	for (int i = 0; i < COUNT(part); i++)
		json_object_set_new(data, part[i].key, json_string(part[i].text));
	char *js = mem_printf("%s%s%s%s%s", viewer_tissue_js, viewer_motion_js, viewer_gl_js, viewer_scene_js, viewer_page_js);
	json_object_set_new(data, "js", json_string(js));
	free(js);
}

static bool write_page(struct stage *stage, const struct capture *capture, const struct render_conf *conf, json_t *eyes,
                       struct err *err)
{
	struct page page = { stage, capture, conf, conf->page_px, json_array(), json_array(), json_array() };
	char *full = realpath(stage->capture, 0), *html, *text;
	const char *base = full && strrchr(full, '/') ? strrchr(full, '/') + 1 : "capture";
	json_t *data = json_object(), *state = json_object();
	json_object_set_new(state, "title", template_text(*base ? base : "capture"));
	json_object_set(state, "eyes", eyes);
	json_object_set_new(state, "motion", motion(stage));
	json_object_set_new(state, "version", json_string(EYEWRIGHT_VERSION));
	text = script_text(state);
	json_object_set_new(data, "title", template_text(*base ? base : "capture"));
	json_object_set_new(data, "version", json_string(EYEWRIGHT_VERSION));
	json_object_set_new(data, "stills", stills(&page));
	json_object_set_new(data, "data", json_string(text));
	programs(data);
	size_t size;
	bool ok = template_fill(&html, &size, viewer_html, data, err) && file_write(stage_path(stage, "%s", out), html, size, err);
	if (ok)
		stage_note(stage, "%s, %.1f MB", stage_path(stage, "%s", out), (double)size / 1e6);
	free(ok ? html : 0);
	free(text);
	free(full);
	json_decref(data);
	json_decref(state);
	json_decref(page.advice);
	json_decref(page.film);
	json_decref(page.missing);
	return ok;
}

bool viewer_make(struct stage *stage, const struct capture *capture, const struct eye *eye, const struct render_conf *conf,
                 struct err *err)
{
	struct job *job = mem_new((size_t)capture->n_eyes + 1, sizeof *job);
	bool *usable = mem_new((size_t)capture->n_eyes + 1, sizeof *usable), ok = true;
	const char **in = mem_new((size_t)capture->n_eyes * (COUNT(job->in) + 2) + 1, sizeof *in);
	int n = 0, opened = 0;
	for (; ok && opened < capture->n_eyes; opened++) {
		ok = job_open(&job[opened], &usable[opened], stage, capture, opened, eye, conf, err);
		for (int i = 0; ok && usable[opened] && i < job[opened].n_in; i++)
			in[n++] = job[opened].in[i];
	}
	if (ok && n && !stage_fresh(stage, out, n, in)) {
		json_t *eyes = json_array();
		for (int i = 0; ok && i < opened; i++) {
			json_t *one = usable[i] && job_ready(&job[i], err) ? viewer_eye(&job[i], err) : 0;
			ok = !usable[i] || one;
			if (one)
				json_array_append_new(eyes, one);
		}
		ok = ok && write_page(stage, capture, conf, eyes, err) && stage_made(stage, out, n, in, err);
		json_decref(eyes);
	}
	for (int i = 0; i < opened; i++)
		job_close(&job[i]);
	free(job);
	free(usable);
	free(in);
	return ok;
}
