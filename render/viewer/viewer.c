#include "render/viewer/viewer.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/version.h"
#include "draw/web/base64.h"
#include "draw/web/eye.h"
#include "draw/web/face.h"
#include "render/page/embed.h"
#include "render/page/page.h"

static const char *const out = "work/review/viewer.html";

/* JSON as the text of a script element; every "<" is escaped, so that nothing can end the element. free(). */
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

/* The configuration of eye movements: animate's defaults, and what this folder's capture.conf changes. */
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

/* Adds shaders and scripts; those of a face only where there is one. */
static void programs(json_t *data, bool face)
{
	const struct {
		const char *key, *text;
	} part[] = { { "css", viewer_css }, { "look", scene_look }, { "common", viewer_common }, { "decode", viewer_decode }, { "paths", viewer_paths }, { "refine", viewer_refine }, { "ground", viewer_ground }, { "lights", viewer_lights }, { "beside", viewer_beside }, { "march", viewer_march }, { "horizon", viewer_horizon },
		         { "iris", viewer_iris }, { "eye_frag", viewer_eye_frag }, { "bloom", viewer_bloom }, { "present", viewer_present } },
	  of_face[] = { { "skin_look", skin_look }, { "lids", viewer_lids }, { "tear", viewer_tear }, { "skin", viewer_skin_frag },
		            { "skin_vert", viewer_skin_vert }, { "folds", viewer_folds }, { "dress", viewer_dress }, { "pose", viewer_pose }, { "probe", viewer_probe }, { "copy", viewer_copy } };
	json_t *sub = json_object();
	for (int i = 0; i < COUNT(part); i++)
		json_object_set_new(data, part[i].key, json_string(part[i].text));
	for (int i = 0; i < COUNT(of_face); i++)
		json_object_set_new(sub, of_face[i].key, json_string(of_face[i].text));
	json_object_set_new(data, "face", face ? json_pack("[o]", json_incref(sub)) : json_array());
	json_decref(sub);
	char *js = mem_printf("%s%s%s%s%s%s%s%s%s%s%s%s%s%s%s%s", viewer_tissue_js, viewer_motion_js, viewer_gl_js, viewer_scene_js, viewer_beams_js, face ? viewer_known_js : "", face ? viewer_pose_js : "", face ? viewer_face_js : "",
	                      viewer_sliders_js, viewer_panorama_js, viewer_address_js, viewer_controls_js, viewer_tools_js, viewer_leaves_js, viewer_live_js, viewer_page_js);
	json_object_set_new(data, "js", json_string(js));
	free(js);
}

static bool write_page(struct stage *stage, const struct capture *capture, const struct render_conf *conf, json_t *eyes,
                       json_t *face, json_t *glbs, json_t *left, struct err *err)
{
	struct page page = { stage, capture, conf, conf->page_px, json_array(), json_array(), json_array() };
	char *full = realpath(stage->capture, 0), *html, *text;
	const char *base = full && strrchr(full, '/') ? strrchr(full, '/') + 1 : "capture";
	json_t *data = json_object(), *state = json_object();
	json_object_set_new(state, "title", template_text(*base ? base : "capture"));
	json_object_set(state, "eyes", eyes);
	if (face)
		json_object_set(state, "face", face);
	json_object_set(state, "left", left);
	json_object_set_new(state, "bloom", json_real(conf->finish.bloom));
	json_object_set_new(state, "tone", json_real(conf->finish.tone));
	json_object_set_new(state, "motion", motion(stage));
	json_object_set_new(state, "version", json_string(EYEWRIGHT_VERSION));
	text = script_text(state);
	json_object_set_new(data, "title", template_text(*base ? base : "capture"));
	json_object_set_new(data, "version", json_string(EYEWRIGHT_VERSION));
	json_object_set_new(data, "stills", stills(&page));
	json_object_set_new(data, "data", json_string(text));
	json_object_set(data, "glbs", glbs);
	programs(data, face);
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

/* Files that the page is made of. */
struct parts {
	struct jobs *eyes;
	int n_in;
	const char **in;
	struct skin_target target;  // the character; without a name: none
	const char *glb;   // as it has left; null: it has not
};

static void find_eyes(struct parts *p)
{
	for (int e = 0; e < p->eyes->n; e++) {
		const struct job *job = &p->eyes->job[e];
		for (int i = 0; job->usable && i < job->n_in; i++)
			p->in[p->n_in++] = job->in[i];
	}
}

static bool find_character(struct parts *p, struct skin_job *skin, struct err *err)
{
	struct stage *stage = skin->stage;
	static const char *const driven[] = { "work/skin/gaze.csv", "work/skin/animation.csv", "work/skin/wrinkles.json", "work/skin/wrinkles.exr" };
	if (!skin_first(&p->target, stage, err))
		return false;
	skin_film(&p->target, stage, skin->conf);
	if (p->target.name)
		skin_iris(&p->target, skin);
	for (int i = 0; i < p->target.n_in; i++)
		p->in[p->n_in++] = p->target.in[i];
	for (int i = 0; i < COUNT(driven) && p->target.name; i++)
		p->in[p->n_in++] = driven[i];
	const char *glb = p->target.name ? stage_path(stage, "work/render/%s.glb", p->target.name) : 0;
	if (glb && file_exists(glb))
		p->in[p->n_in++] = p->glb = glb + strlen(stage->capture) + 1;
	return true;
}

static bool add_eyes(json_t *eyes, struct parts *p, struct err *err)
{
	for (int i = 0; i < p->eyes->n; i++) {
		struct job *job = &p->eyes->job[i];
		if (!job->usable)
			continue;
		if (!job_ready(job, err))
			return false;
		const struct shot *shot = &job->shots[job->reference];
		char *edge = mem_printf("%s", stage_path(job->stage, "%.*s.edge.json", (int)(strlen(shot->photo->fit) - strlen(".json")), shot->photo->fit));
		const struct web_source source = { &job->scene, job->names->side, stage_path(job->stage, "%s", job->in[3]),
			                                  &job->studio, job->gain, shot, edge, job->conf->lights, job->conf->light_directions };
		json_t *one = web_eye(&source, err);
		free(edge);
		if (!one)
			return false;
		json_array_append_new(eyes, one);
	}
	return true;
}

/* Recorded gaze and the script's, where they are. */
static bool add_clips(json_t *face, struct skin_job *skin, struct err *err)
{
	static const char *const clips[][2] = { { "work/skin/gaze.csv", "As recorded" }, { "work/skin/animation.csv", "Cut-scene" } };
	json_t *list = json_array();
	bool ok = true;
	for (int i = 0; i < COUNT(clips) && ok; i++) {
		const char *path = stage_path(skin->stage, "%s", clips[i][0]);
		struct drive drive;
		if (!file_exists(path))
			continue;
		ok = drive_load(&drive, &skin->model, path, err);
		if (ok) {
			json_array_append_new(list, web_clip(clips[i][1], &drive));
			drive_free(&drive);
		}
	}
	json_object_set_new(face, "clips", list);
	return ok;
}

/* The character and, where there is no other, its plain eye. */
static bool add_face(json_t **face, json_t *eyes, struct skin_job *skin, struct skin_target *target, struct err *err)
{
	bool ok = skin_open(skin, target, err);
	if (ok && !json_array_size(eyes)) {
		const struct web_source plain = { skin->eyes[0], "eye", 0, &skin->studio, skin->gain, 0, 0, skin->render->lights, skin->render->light_directions };
		json_t *one = web_eye(&plain, err);
		ok = one;
		if (one)
			json_array_append_new(eyes, one);
	}
	if (ok) {
		*face = web_face(target->name, target->portrait, &skin->model, skin->gain, skin->eyes, err);
		ok = *face && add_clips(*face, skin, err);
	}
	skin_free(target);
	return ok;
}

/* The character as it has left, unless that is large: left then says which file, and both sizes in MiB. */
static void add_face_glb(json_t *glbs, json_t *left, struct parts *p, struct skin_job *skin)
{
	const double mib = 1 << 20, most = skin->render->page_glb_mib;
	char *bytes = 0;
	size_t size;
	struct err large = { 0 };
	struct stat st;
	const char *path = p->glb ? stage_path(skin->stage, "%s", p->glb) : 0;
	if (path && file_read(&bytes, &size, path, (size_t)(most * mib), &large)) {
		json_array_append_new(glbs, json_pack("{s:s,s:o}", "of", "face", "base64", base64_json(bytes, size)));
	} else if (path && !stat(path, &st)) {
		json_object_set_new(left, "file", template_text(p->glb));
		json_object_set_new(left, "mib", json_real((double)st.st_size / mib));
		json_object_set_new(left, "most", json_real(most));
	}
	free(bytes);
}

/* What can leave the page: the character; else each eye by itself, where exports are made with the pictures: it takes a fifth of the time of a
 * draft. */
static bool add_glbs(json_t *glbs, json_t *left, struct parts *p, struct skin_job *skin, struct err *err)
{
	char *bytes;
	size_t size;
	if (p->target.name) {
		add_face_glb(glbs, left, p, skin);
		return true;
	}
	for (int i = 0, n = 0; i < p->eyes->n && skin->leaves->make; i++) {
		const struct job *job = &p->eyes->job[i];
		if (!job->usable)
			continue;
		if (!export_in_face(&bytes, &size, &job->scene, &job->studio, skin->leaves, err))
			return false;
		json_array_append_new(glbs, json_pack("{s:i,s:o}", "of", n++, "base64", base64_json(bytes, size)));
		free(bytes);
	}
	return true;
}

static bool make(struct parts *p, struct skin_job *skin, struct err *err)
{
	json_t *eyes = json_array(), *face = 0, *glbs = json_array(), *left = json_object();
	bool ok = add_eyes(eyes, p, err) && (!p->target.name || add_face(&face, eyes, skin, &p->target, err)) && add_glbs(glbs, left, p, skin, err)
	          && write_page(skin->stage, skin->capture, skin->render, eyes, face, glbs, left, err)
	          && stage_made(skin->stage, out, p->n_in, p->in, err);
	json_decref(eyes);
	json_decref(face);
	json_decref(glbs);
	json_decref(left);
	return ok;
}

bool viewer_make(struct skin_job *skin, struct err *err)
{
	struct jobs *eyes = skin->photographed;
	struct parts p = { .eyes = eyes, .in = mem_new((size_t)eyes->n * COUNT(eyes->job->in) + COUNT(((struct skin_target *)0)->in) + 8, sizeof *p.in) };
	find_eyes(&p);
	bool ok = find_character(&p, skin, err);
	if (ok && p.n_in && !stage_fresh(skin->stage, out, p.n_in, p.in))
		ok = make(&p, skin, err);
	free(p.in);
	return ok;
}
