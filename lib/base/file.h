/* file: whole files in and out, hashes, folders. Paths are passed to the system as they are:
 * no shell, no pattern. */
#ifndef BASE_FILE_H
#define BASE_FILE_H
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The whole file, with a zero byte behind it. *data is the caller's, free().
 * False, err set, when it is not a regular file, cannot be read, or is longer than `limit` bytes. */
bool file_read(char **data, size_t *size, const char *path, size_t limit, struct err *err);

/* Writes beside `path`, flushes and renames: a reader sees the old file or the new one, whole.
 * Folders on the way are made. On failure what stood there stays. */
bool file_write(const char *path, const void *data, size_t size, struct err *err);

/* mkdir -p */
bool file_mkdirs(const char *dir, struct err *err);

bool file_exists(const char *path);

/* A missing file is no error. */
bool file_remove(const char *path, struct err *err);

/* 128-bit XXH3 of the bytes, as 32 hexadecimal digits and a zero. */
void file_hash_bytes(char out[33], const void *data, size_t size);

/* The same of a file; hashed in pieces, never held whole. False when it cannot be read. */
bool file_hash(char out[33], const char *path, struct err *err);

/* Names in `dir` (no path), sorted by bytes; those beginning with a dot are left out.
 * A missing folder is empty. names: free with file_list_free. */
struct file_list {
	char **names;
	int n;
};
bool file_list(struct file_list *out, const char *dir, struct err *err);
void file_list_free(struct file_list *list);

/* Joins and resolves links; false, err set, when the result lies outside `root` or does not exist.
 * *out: free(). */
bool file_inside(char **out, const char *root, const char *rel, struct err *err);

/* A name beside `path` to write under until it is whole: short whatever the path's length, the same at every run, so that
 * a killed run leaves at most one behind, which the next overwrites, or work_sweep (work.h) removes. free(). */
char *file_temporary(const char *path);

/* Whether file_temporary gives such names (without folders). */
bool file_is_temporary(const char *name);

#ifdef __cplusplus
}
#endif
#endif
