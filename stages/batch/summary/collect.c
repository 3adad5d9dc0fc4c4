#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/template.h"
#include "image/photo/photo.h"
#include "image/picture.h"
#include "summary.h"

enum { FILE_LIMIT = 16 << 20, FILES_MOST = 2000, THUMB_MPX = 30, THUMB_QUALITY = 82 };

char *summary_path(const char *dir, const char *folder, const char *name, const char *ending)
{
	char hash[33];
	file_hash_bytes(hash, name, strlen(name));
	return mem_printf("%s/batch/%s/%s%s", dir, folder, hash, ending);
}

/* Null where there is none, or none that can be read. */
static json_t *read_quietly(const char *path)
{
	struct err none = { 0 };
	return file_exists(path) ? json_read(path, FILE_LIMIT, &none) : 0;
}

static void add_file(json_t *records, const char *work, const char *file, const char *part, const char *of)
{
	char *path = mem_printf("%s/%s", work, file);
	json_t *json = read_quietly(path);
	if (json)
		record_add(records, part, of, json);
	json_decref(json);
	free(path);
}

/* One record for each file of a folder with that ending: of what stands before it. */
static void add_folder(json_t *records, const char *work, const char *folder, const char *ending, const char *part)
{
	struct file_list list = { 0 };
	struct err none = { 0 };
	char *path = mem_printf("%s/%s", work, folder);
	const size_t e = strlen(ending);
	file_list(&list, path, &none);
	for (int i = 0; i < list.n && i < FILES_MOST; i++) {
		const size_t n = strlen(list.names[i]);
		if (n <= e || strcmp(list.names[i] + n - e, ending) || strstr(list.names[i], ".edge.json"))
			continue;
		char *file = mem_printf("%s/%s", folder, list.names[i]), *of = mem_printf("%.*s", (int)(n - e), list.names[i]);
		add_file(records, work, file, part, of);
		free(file);
		free(of);
	}
	file_list_free(&list);
	free(path);
}

/* What unrefract found of each photograph of an eye. */
static void add_photographs(json_t *records, const char *work, const char *file)
{
	char *path = mem_printf("%s/%s", work, file);
	json_t *json = read_quietly(path), *photos = json_object_get(json, "photos"), *photo;
	size_t i;
	json_array_foreach(photos, i, photo) {
		const char *name = json_string_value(json_object_get(photo, "name"));
		if (name && i < FILES_MOST)
			record_add(records, "unrefract", name, photo);
	}
	json_decref(json);
	free(path);
}

static void add_eyes(json_t *records, const char *work)
{
	static const char *const sides[] = { "", "_left", "_right" }, *const files[] = { "texture", "pigment", "relief", "freckles" };
	for (int s = 0; s < COUNT(sides); s++) {
		for (int f = 0; f < COUNT(files); f++) {
			char *file = mem_printf("iris%s/%s.json", sides[s], files[f]);
			add_file(records, work, file, files[f], *sides[s] ? sides[s] + 1 : "");
			if (!f)
				add_photographs(records, work, file);
			free(file);
		}
		char *render = mem_printf("render%s", sides[s]);
		add_folder(records, work, render, "_compare.json", "compare");
		free(render);
	}
}

static void add_targets(json_t *records, const char *work)
{
	struct file_list list = { 0 };
	struct err none = { 0 };
	char *path = mem_printf("%s/targets", work);
	file_list(&list, path, &none);
	for (int i = 0; i < list.n && i < FILES_MOST; i++) {
		char *file = mem_printf("targets/%s/registration.json", list.names[i]);
		add_file(records, work, file, "registration", list.names[i]);
		free(file);
	}
	file_list_free(&list);
	free(path);
}

static json_t *collect_records(const char *work)
{
	json_t *records = json_array();
	add_file(records, work, "rig.json", "rig", "");
	add_folder(records, work, "limbus", ".json", "limbus");
	add_eyes(records, work);
	add_file(records, work, "skin/track.json", "track", "");
	add_file(records, work, "skin/train.json", "train", "");
	add_file(records, work, "skin/model.json", "model", "");
	add_targets(records, work);
	return records;
}

/* First file of a folder with that ending; null: there is none. free(). */
static char *first_of(const char *work, const char *folder, const char *ending)
{
	struct file_list list = { 0 };
	struct err none = { 0 };
	char *path = mem_printf("%s/%s", work, folder), *found = 0;
	const size_t e = strlen(ending);
	file_list(&list, path, &none);
	for (int i = 0; i < list.n && !found; i++) {
		const size_t n = strlen(list.names[i]);
		if (n > e && !strcmp(list.names[i] + n - e, ending))
			found = mem_printf("%s/%s", path, list.names[i]);
	}
	file_list_free(&list);
	free(path);
	return found;
}

/* The picture to judge a capture by: the limbus found in the photograph that is most likely wrong, else a driven character, else what was tracked. */
static char *picture_of(const char *work, const json_t *records)
{
	double worst = -1;
	char *path = 0;
	size_t i;
	const json_t *record;
	json_array_foreach(records, i, record) {
		const double gross = record_number(record, "gross_probability"), at = isfinite(gross) ? gross : 0;
		if (strcmp(json_string_value(json_object_get(record, "part")), "limbus") || at <= worst)
			continue;
		char *png = mem_printf("%s/limbus/%s.png", work, json_string_value(json_object_get(record, "of")));
		if (file_exists(png)) {
			free(path);
			path = png;
			worst = at;
		} else
			free(png);
	}
	static const char *const others[][2] = { { "render", "_look.png" }, { "skin", "refused.png" }, { "skin", "track.png" } };
	for (int k = 0; k < COUNT(others) && !path; k++)
		path = first_of(work, others[k][0], others[k][1]);
	return path;
}

/* The picture made small, as JPEG. False where there is none that can be read. */
static bool shrink(uint8_t **jpeg, size_t *size, const char *path, int width)
{
	struct photo photo = { 0 };
	struct err none = { 0 };
	bool ok = photo_load(&photo, path, THUMB_MPX, &none);
	// A sheet of pictures is cut to its beginning.
	if (ok) {
		const int tall = photo.height < photo.width ? photo.height : photo.width;
		const int w = width < photo.width ? width : photo.width, h = (int)fmax(1, (double)w * tall / photo.width);
		struct image small = photo_shrunk(&photo, 0, 0, photo.width, tall, w, h);
		uint8_t *px = image_to_srgb8(&small);
		ok = picture_jpeg_encode(jpeg, size, px, w, h, 3, THUMB_QUALITY, &none);
		free(px);
		image_free(&small);
	}
	photo_free(&photo);
	return ok;
}

/* Makes the capture's picture anew where its source has changed. Returns what its source was, or null: there is no picture. */
static json_t *thumb(const char *dir, const char *name, const char *path, const json_t *was, int width, struct err *err)
{
	struct stat st;
	char *to = summary_path(dir, "thumbs", name, ".jpg");
	json_t *source = path && !stat(path, &st)
	                         ? json_pack("[i,I,I,I]", width, (json_int_t)st.st_size, (json_int_t)st.st_mtim.tv_sec, (json_int_t)st.st_mtim.tv_nsec)
	                         : 0;
	uint8_t *jpeg = 0;
	size_t size;
	if (source && !(json_equal(source, was) && file_exists(to))
	    && !(shrink(&jpeg, &size, path, width) && file_write(to, jpeg, size, err))) {
		json_decref(source);
		source = 0;
	}
	if (!source)
		file_remove(to, err);
	free(jpeg);
	free(to);
	return source;
}

bool summary_collect(const char *dir, const char *name, const struct summary_conf *conf, struct err *err)
{
	struct err none = { 0 };
	char *row = summary_path(dir, "rows", name, ".json"), *work = mem_printf("%s/%s/work", dir, name), *page = mem_printf("%s/review/index.html", work);
	json_t *was = json_read(row, ROW_LIMIT, &none), *records = collect_records(work);
	char *picture = picture_of(work, records);
	json_t *source = thumb(dir, name, picture, json_object_get(was, "thumb"), conf->thumb_px, err);
	json_t *now = json_pack("{s:o,s:b,s:o?}", "records", records, "review", file_exists(page), "thumb", source);
	char *text = json_dumps(now, JSON_COMPACT | JSON_REAL_PRECISION(12)), *old = was ? json_dumps(was, JSON_COMPACT | JSON_REAL_PRECISION(12)) : 0;
	bool ok = !err_is(err) && ((old && !strcmp(old, text)) || file_write(row, text, strlen(text), err));
	free(text);
	free(old);
	json_decref(now);
	json_decref(was);
	free(picture);
	free(row);
	free(work);
	free(page);
	return ok;
}
