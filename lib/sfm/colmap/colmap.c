#include "sfm/colmap/colmap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "math/vec.h"
#include "sfm/colmap/parse.h"

enum { FILES = 3 };
static const size_t file_limit = (size_t)2 << 30;
static const char *const stems[FILES] = { "cameras", "images", "points3D" };

static const struct {
	const char *name;
	int params;
} kinds[COLMAP_KINDS] = {
	[COLMAP_SIMPLE_PINHOLE] = { "SIMPLE_PINHOLE", 3 },
	[COLMAP_PINHOLE] = { "PINHOLE", 4 },
	[COLMAP_SIMPLE_RADIAL] = { "SIMPLE_RADIAL", 4 },
	[COLMAP_RADIAL] = { "RADIAL", 5 },
	[COLMAP_OPENCV] = { "OPENCV", 8 },
	[COLMAP_OPENCV_FISHEYE] = { "OPENCV_FISHEYE", 8 },
	[COLMAP_FULL_OPENCV] = { "FULL_OPENCV", 12 },
	[COLMAP_FOV] = { "FOV", 5 },
	[COLMAP_SIMPLE_RADIAL_FISHEYE] = { "SIMPLE_RADIAL_FISHEYE", 4 },
	[COLMAP_RADIAL_FISHEYE] = { "RADIAL_FISHEYE", 5 },
	[COLMAP_THIN_PRISM_FISHEYE] = { "THIN_PRISM_FISHEYE", 12 },
};

const char *colmap_kind_name(enum colmap_kind kind)
{
	return kinds[kind].name;
}

int colmap_kind_params(enum colmap_kind kind)
{
	return kinds[kind].params;
}

bool colmap_parse(struct colmap_model *model, enum colmap_format format, const char *const data[3], const size_t size[3],
                  const char *const where[3], struct err *err)
{
	struct colmap_raw raw = { 0 };
	*model = (struct colmap_model){ 0 };
	bool ok = (format == COLMAP_TEXT ? colmap_parse_text : colmap_parse_binary)(model, &raw, data, size, where, err)
	          && colmap_link(model, &raw, where, err);
	free(raw.seen_point);
	free(raw.image_camera);
	free(raw.track);
	if (!ok)
		colmap_free(model);
	return ok;
}

static char *seal_path(const char *dir)
{
	return mem_printf("%s/seal", dir);
}

static char *seal_of(char *const data[FILES], const size_t size[FILES])
{
	char hash[FILES][33];
	for (int i = 0; i < FILES; i++)
		file_hash_bytes(hash[i], data[i], size[i]);
	return mem_printf("%s\n%s\n%s\n", hash[0], hash[1], hash[2]);
}

static bool seal_holds(const char *dir, char *const data[FILES], const size_t size[FILES], struct err *err)
{
	char *path = seal_path(dir), *was = 0, *now = 0;
	size_t n;
	bool ok = true;
	if (file_exists(path)) {
		now = seal_of(data, size);
		ok = file_read(&was, &n, path, 200, err)
		     && (!strcmp(was, now) || err_set(err, "%s: its files are not the ones that were sealed: remove it", dir));
	}
	free(path);
	free(was);
	free(now);
	return ok;
}

struct files {
	char *data[FILES], *path[FILES];
	size_t size[FILES];
	enum colmap_format format;
};

static bool read_files(struct files *f, const char *dir, struct err *err)
{
	*f = (struct files){ 0 };
	char *binary = mem_printf("%s/%s.bin", dir, stems[0]);
	f->format = file_exists(binary) ? COLMAP_BINARY : COLMAP_TEXT;
	free(binary);
	bool ok = true;
	for (int i = 0; i < FILES; i++) {
		f->path[i] = mem_printf("%s/%s.%s", dir, stems[i], f->format == COLMAP_BINARY ? "bin" : "txt");
		ok = ok && file_read(&f->data[i], &f->size[i], f->path[i], file_limit, err);
	}
	return ok;
}

static void free_files(struct files *f)
{
	for (int i = 0; i < FILES; i++) {
		free(f->data[i]);
		free(f->path[i]);
	}
}

bool colmap_load(struct colmap_model *model, const char *dir, struct err *err)
{
	struct files f;
	*model = (struct colmap_model){ 0 };
	bool ok = read_files(&f, dir, err) && seal_holds(dir, f.data, f.size, err)
	          && colmap_parse(model, f.format, (const char *const *)f.data, f.size, (const char *const *)f.path, err);
	free_files(&f);
	return ok;
}

bool colmap_seal(const char *dir, struct err *err)
{
	struct files f;
	char *path = seal_path(dir), *seal = 0;
	bool ok = read_files(&f, dir, err);
	if (ok) {
		seal = seal_of(f.data, f.size);
		ok = file_write(path, seal, strlen(seal), err);
	}
	free_files(&f);
	free(seal);
	free(path);
	return ok;
}

void colmap_free(struct colmap_model *model)
{
	for (int i = 0; i < model->n_images; i++) {
		free(model->images[i].name);
		free(model->images[i].seen);
	}
	for (int i = 0; i < model->n_points; i++)
		free(model->points[i].track);
	free(model->cameras);
	free(model->images);
	free(model->points);
	*model = (struct colmap_model){ 0 };
}
