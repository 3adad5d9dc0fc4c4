#include "tests/lib/score/series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zip.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "bridge/om_mesh.h"
#include "image/exr.h"
#include "image/photo/photo.h"
#include "image/video/video.h"
#include "tests/peers/exr_channels.h"

static const size_t LIMIT = (size_t)1 << 30;

/* The series of that name, begun where there is none. */
static struct series *series_of(struct series_list *list, const char *name)
{
	for (int i = list->n - 1; i >= 0; i--)
		if (!strcmp(list->of[i].name, name))
			return &list->of[i];
	list->of = mem_grow(list->of, (size_t)list->n + 1, sizeof *list->of);
	list->of[list->n] = (struct series){ .name = mem_str(name) };
	return &list->of[list->n++];
}

static double *add(struct series_list *list, const char *name, long n)
{
	struct series *s = series_of(list, name);
	s->v = mem_grow(s->v, (size_t)(s->n + n) + 1, sizeof *s->v);
	s->n += n;
	return s->v + s->n - n;
}

static void add_text(struct series_list *list, const char *text)
{
	char *more = mem_printf("%s%s\n", list->text ? list->text : "", text);
	free(list->text);
	list->text = more;
}

static bool read_exr(struct series_list *list, const char *path, struct err *err)
{
	char *names;
	if (!exr_channels(&names, path, err))
		return false;
	bool ok = true;
	for (char *rest = names, *name; ok && (name = strsep(&rest, ","));) {
		struct image map;
		name += strspn(name, " ");
		if ((ok = exr_read(&map, path, 1, (const char *const[]){ name }, 1L << 28, 0, err))) {
			long n = (long)map.width * map.height;
			double *v = add(list, name, n);
			for (long i = 0; i < n; i++)
				v[i] = (double)map.px[i];
			image_free(&map);
		}
	}
	free(names);
	return ok;
}

static bool read_picture(struct series_list *list, const char *path, struct err *err)
{
	struct photo photo;
	if (!photo_load(&photo, path, 1000, err))
		return false;
	long n = 3L * photo.width * photo.height;
	double *v = add(list, "rgb", n);
	for (long i = 0; i < n; i++)
		v[i] = photo.rgb[i];
	photo_free(&photo);
	return true;
}

static bool names_source(const char *key)
{
	return !strcmp(key, "made_by") || strstr(key, "hash") || strstr(key, "seconds");
}

static void read_value(struct series_list *list, const char *name, const json_t *value)
{
	const char *key;
	json_t *item;
	size_t i;
	if (json_is_object(value))
		json_object_foreach((json_t *)value, key, item) {
			char *deeper = mem_printf("%s.%s", name, key);
			if (!names_source(key))
				read_value(list, deeper, item);
			free(deeper);
		}
	json_array_foreach(value, i, item)
		read_value(list, name, item);
	if (json_is_number(value) || json_is_null(value))
		*add(list, name, 1) = json_is_null(value) ? NAN : json_number_value(value);
	if (json_is_string(value))
		add_text(list, json_string_value(value));
}

static bool read_json(struct series_list *list, const char *path, struct err *err)
{
	json_t *json = json_read(path, LIMIT, err);
	if (json)
		read_value(list, "", json);
	json_decref(json);
	return json;
}

static bool read_csv(struct series_list *list, const char *path, struct err *err)
{
	struct csv_table table;
	bool ok = csv_read(&table, path, err);
	for (int c = 0; ok && c < table.n_columns; c++) {
		double *v = add(list, table.names[c], table.n_rows);
		for (long i = 0; i < table.n_rows; i++)
			v[i] = csv_at(&table, i, c);
	}
	csv_table_free(&table);
	return ok;
}

static void add_array(struct series_list *list, const char *name, const struct npy *array)
{
	double *v = npy_doubles(array);
	memcpy(add(list, name, npy_count(array)), v, (size_t)npy_count(array) * sizeof *v);
	free(v);
}

static bool read_npy(struct series_list *list, const char *path, struct err *err)
{
	struct npy array;
	bool ok = npy_read(&array, path, LIMIT, err);
	if (ok)
		add_array(list, "array", &array);
	npy_free(&array);
	return ok;
}

static bool read_npz(struct series_list *list, const char *path, struct err *err)
{
	zip_t *zip = zip_open(path, ZIP_RDONLY, 0);
	if (!zip)
		return err_set(err, "%s: no zip", path);
	bool ok = true;
	for (zip_int64_t i = 0; ok && i < zip_get_num_entries(zip, 0); i++) {
		const char *entry = zip_get_name(zip, (zip_uint64_t)i, 0), *dot = strstr(entry, ".npy");
		if (!dot)
			continue;
		char *name = mem_printf("%.*s", (int)(dot - entry), entry);
		struct npy array;
		if ((ok = npz_read(&array, path, name, LIMIT, err))) {
			add_array(list, name, &array);
			npy_free(&array);
		}
		free(name);
	}
	zip_discard(zip);
	return ok;
}

static bool read_mesh(struct series_list *list, const char *path, struct err *err)
{
	struct mesh mesh;
	if (!om_mesh_load(&mesh, path, 1L << 26, err))
		return false;
	double *v = add(list, "vertices", 3L * mesh.n_vertices);
	for (long i = 0; i < 3L * mesh.n_vertices; i++)
		v[i] = (double)mesh.vertices[i / 3][i % 3];
	v = add(list, "faces", 3L * mesh.n_faces);
	for (long i = 0; i < 3L * mesh.n_faces; i++)
		v[i] = mesh.faces[i / 3][i % 3];
	mesh_free(&mesh);
	return true;
}

static bool read_video(struct series_list *list, const char *path, struct err *err)
{
	struct video_info info;
	struct video *video = video_open(&info, path, &(struct video_conf){ 200, 1000000, 1, 0 }, err);
	struct video_frame frame;
	bool got = video, ok = video;
	while (ok && got && (ok = video_next(&frame, &got, video, err)) && got) {
		double *v = add(list, "luma", (long)frame.width * frame.height);
		for (int y = 0; y < frame.height; y++)
			for (int x = 0; x < frame.width; x++)
				*v++ = frame.luma[(long)y * frame.luma_stride + x];
		video_frame_free(&frame);
	}
	video_close(video);
	return ok;
}

/* glTF 2.0 binary: every accessor's smallest and largest, the nodes, the times; pictures inside it are left out. */
static bool read_glb(struct series_list *list, const char *path, struct err *err)
{
	char *data;
	size_t size;
	uint32_t head[5];
	if (!file_read(&data, &size, path, LIMIT, err))
		return false;
	if (size > sizeof head)
		memcpy(head, data, sizeof head);
	json_t *json = size > sizeof head && head[3] <= size - sizeof head ? json_loadb(data + sizeof head, head[3], 0, 0) : 0;
	json_object_del(json, "bufferViews");  // where pictures lie, whose files have sizes of their own
	json_object_del(json, "buffers");
	json_object_del(json, "asset");
	if (json)
		read_value(list, "", json);
	else
		err_set(err, "%s: no glTF", path);
	json_decref(json);
	free(data);
	return json;
}

bool series_read(struct series_list *out, const char *path, struct err *err)
{
	static const struct {
		const char *ending;
		bool (*read)(struct series_list *, const char *, struct err *);
	} kinds[] = { { ".exr", read_exr }, { ".png", read_picture }, { ".json", read_json }, { ".csv", read_csv }, { ".npy", read_npy },
		{ ".npz", read_npz }, { ".ply", read_mesh }, { ".mp4", read_video }, { ".glb", read_glb } };
	const char *dot = strrchr(path, '.');
	*out = (struct series_list){ 0 };
	for (int i = 0; dot && i < COUNT(kinds); i++)
		if (!strcmp(dot, kinds[i].ending))
			return kinds[i].read(out, path, err);
	return err_set(err, "%s: of no kind that is compared", path);
}

void series_free(struct series_list *list)
{
	for (int i = 0; i < list->n; i++) {
		free(list->of[i].name);
		free(list->of[i].v);
	}
	free(list->of);
	free(list->text);
	*list = (struct series_list){ 0 };
}
