/* A model's files, and the seal that tells whether their bytes are still those that were sealed. */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "sfm/colmap/colmap.h"

enum { FILES = 3 };
static const size_t file_limit = (size_t)2 << 30;
static const char *const stems[FILES] = { "cameras", "images", "points3D" };

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
