#include "anatomy/capture.h"

#include <stdlib.h>
#include <string.h>

#include "anatomy/keys.h"
#include "base/mem.h"
#include "image/photo/photo.h"

enum { SIDES = 3 };
static const char *const side_names[SIDES] = { "eye", "left", "right" };
static const char *const iris_dirs[SIDES] = { "work/iris_eye", "work/iris_left", "work/iris_right" };
static const char *const render_dirs[SIDES] = { "work/render_eye", "work/render_left", "work/render_right" };
static const char *const export_dirs[SIDES] = { "work/export_eye", "work/export_left", "work/export_right" };

const struct opt_each *capture_each(const struct opt_each_list *list, const char *name)
{
	for (int i = 0; i < list->n; i++)
		if (!strcmp(list->items[i].name, name))
			return &list->items[i];
	return 0;
}

const struct capture_photo *capture_fellow(const struct capture *capture, const struct capture_photo *photo)
{
	for (int i = 0; i < capture->n_photos; i++)
		if (capture->photos[i].eye != photo->eye && strcmp(capture->photos[i].file, photo->file) == 0)
			return &capture->photos[i];
	return 0;
}

const struct opt_each *capture_key(const struct opt_each_list *list, const struct capture_photo *photo)
{
	const struct opt_each *own = capture_each(list, photo->name);
	return own ? own : capture_each(list, photo->whole);
}

static int side_of(const char *name, const struct opt_each_list *eye_of, struct err *err)
{
	const struct opt_each *given = capture_each(eye_of, name);
	if (given) {
		for (int s = 1; s < SIDES; s++)
			if (!strcmp(given->text, side_names[s]))
				return s;
		err_set(err, "capture.conf: photo.%s.eye = %.40s: must be left or right", name, given->text);
		return -1;
	}
	for (int s = 1; s < SIDES; s++) {
		size_t n = strlen(side_names[s]);
		if (!strncmp(name, side_names[s], n) && (name[n] == '_' || !name[n]))
			return s;
	}
	return 0;
}

static char *stem(const char *file)
{
	const char *dot = strrchr(file, '.');
	return dot && dot != file ? mem_printf("%.*s", (int)(dot - file), file) : mem_str(file);
}

/* Which of several files of one name shows the eye best: developed photographs, then raw ones, then what is none. */
static int rank_of(struct stage *stage, const char *file)
{
	enum photo_kind kind = photo_kind_of(stage_path(stage, "%s", file));
	return kind == PHOTO_NONE ? 0 : kind == PHOTO_RAW ? 1 : 2;
}

/* Of files with one name (IMG_7.CR2, IMG_7.JPG, and what a telephone wrote beside them, IMG_7.AAE) one is taken. */
static void add_photo(struct capture *capture, struct stage *stage, char *name, const char *file, int side)
{
	struct capture_photo *twin = 0;
	char *path = mem_printf("photos/%s", file);
	for (int i = 0; i < capture->n_photos; i++)
		if (!strcmp(capture->photos[i].name, name))
			twin = &capture->photos[i];
	if (twin) {
		bool better = rank_of(stage, path) > rank_of(stage, twin->file);
		char *left = better ? twin->file : path;
		twin->file = better ? path : twin->file;
		stage_warn(stage, "%s: left out: %s has the same name", left, twin->file);
		free(left);
		free(name);
		return;
	}
	capture->photos = mem_grow(capture->photos, (size_t)capture->n_photos + 1, sizeof *capture->photos);
	capture->photos[capture->n_photos++] = (struct capture_photo){
		.name = name, .whole = mem_str(name), .file = path, .fit = mem_printf("work/limbus/%s.json", name), .eye = side
	};
}

/* Sides present become eyes[], the first of them in work/iris; in: the photographs' sides, out: their indices into eyes[]. */
static void number_eyes(struct capture *capture)
{
	int index[SIDES];
	capture->n_eyes = 0;
	for (int s = 0; s < SIDES; s++) {
		bool present = false;
		for (int i = 0; i < capture->n_photos; i++)
			present |= capture->photos[i].eye == s;
		index[s] = present ? capture->n_eyes : -1;
		if (!present)
			continue;
		bool first = !capture->n_eyes;
		capture->eyes[capture->n_eyes++] = (struct capture_eye){
			side_names[s], first ? "work/iris" : iris_dirs[s], first ? "work/render" : render_dirs[s],
			first ? "work/export" : export_dirs[s]
		};
	}
	for (int i = 0; i < capture->n_photos; i++)
		capture->photos[i].eye = index[capture->photos[i].eye];
}

bool capture_may_part(const struct capture *capture, int i)
{
	const struct capture_photo *p = &capture->photos[i];
	if (p->part || strcmp(capture->eyes[p->eye].side, side_names[0]))
		return false;
	bool may = true;
	for (int s = 1; s < SIDES; s++) {
		char *name = mem_printf("%s.%s", p->name, side_names[s]);
		for (int k = 0; k < capture->n_photos; k++)
			may = may && strcmp(capture->photos[k].name, name);
		free(name);
	}
	return may;
}

static struct capture_photo part_of(const struct capture_photo *whole, int side)
{
	char *name = mem_printf("%s.%s", whole->name, side_names[side]);
	return (struct capture_photo){ .name = name, .whole = mem_str(whole->name), .file = mem_str(whole->file),
		.fit = mem_printf("work/limbus/%s.json", name), .eye = side, .part = true };
}

static void photo_clear(struct capture_photo *p)
{
	free(p->name);
	free(p->whole);
	free(p->file);
	free(p->fit);
}

static int side_index(const char *side)
{
	int s = SIDES - 1;
	while (s > 0 && strcmp(side, side_names[s]))
		s--;
	return s;
}

void capture_part(struct capture *capture, int i)
{
	for (int k = 0; k < capture->n_photos; k++)
		capture->photos[k].eye = side_index(capture->eyes[capture->photos[k].eye].side);
	capture->photos = mem_grow(capture->photos, (size_t)capture->n_photos + 1, sizeof *capture->photos);
	struct capture_photo *at = &capture->photos[i], whole = *at;
	memmove(at + 2, at + 1, (size_t)(capture->n_photos - i - 1) * sizeof *at);
	capture->n_photos++;
	for (int s = 1; s < SIDES; s++)
		at[s - 1] = part_of(&whole, s);
	photo_clear(&whole);
	number_eyes(capture);
}

/* Whether limbus has found both eyes in it. An input of stages that read nothing else of those fits, too. */
static bool is_parted(struct stage *stage, const struct capture_photo *p)
{
	bool is = true;
	for (int s = 1; s < SIDES && is; s++) {
		char *fit = mem_printf("work/limbus/%s.%s.json", p->name, side_names[s]);
		is = stage_has(stage, fit);
		free(fit);
	}
	return is;
}

bool capture_load(struct capture *capture, struct stage *stage, const struct opt_each_list *eye_of, struct err *err)
{
	if (!capture_list(capture, stage, eye_of, err))
		return false;
	for (int i = 0; i < capture->n_photos; i++)
		if (capture_may_part(capture, i) && is_parted(stage, &capture->photos[i]))
			capture_part(capture, i++);
	return true;
}

bool capture_list(struct capture *capture, struct stage *stage, const struct opt_each_list *eye_of, struct err *err)
{
	struct file_list files;
	*capture = (struct capture){ 0 };
	if (!keys_check_names(&stage->conf, stage->capture, err) || !stage_list(stage, &files, "photos", err))
		return false;
	for (int i = 0; i < files.n; i++) {
		char *name = stem(files.names[i]);
		int side = side_of(name, eye_of, err);
		if (side < 0) {
			free(name);
			break;
		}
		add_photo(capture, stage, name, files.names[i], side);
	}
	file_list_free(&files);
	if (err_is(err)) {
		capture_free(capture);
		return false;
	}
	number_eyes(capture);
	return capture->n_photos ? true : err_set(err, "%s/photos: no photograph there", stage->capture);
}

void capture_free(struct capture *capture)
{
	for (int i = 0; i < capture->n_photos; i++)
		photo_clear(&capture->photos[i]);
	free(capture->photos);
	*capture = (struct capture){ 0 };
}
