/* file: whole files in and out, hashes, folders. Paths are passed to the system unchanged: no shell, no patterns. */
#ifndef BASE_FILE_H
#define BASE_FILE_H
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a whole file. *data: its bytes and a zero byte behind them, free(); *size: without that byte.
 * Returns false, err set, when it is not a regular file, cannot be read, or is longer than `limit` bytes. */
bool file_read(char **data, size_t *size, const char *path, size_t limit, struct err *err);

/* Writes a whole file: beside `path`, flushed, then renamed, so that a reader sees the old file or the new one, never a part.
 * Missing folders are made. Returns false, err set, on failure; the old file then stays. */
bool file_write(const char *path, const void *data, size_t size, struct err *err);

/* The same of several parts, one after the other: what is long need not be copied behind its head. */
struct file_part {
	const void *data;
	size_t size;
};
bool file_write_parts(const char *path, int n, const struct file_part part[], struct err *err);

/* Makes a folder and those above it (mkdir -p). Returns false, err set, when that fails. */
bool file_mkdirs(const char *dir, struct err *err);

bool file_exists(const char *path);

/* Whether a library may open it by its path: a regular file of at most `limit` bytes, or nothing, which the library reports. A pipe
 * would hold it for ever. False, err set, otherwise. */
bool file_opens(const char *path, uint64_t limit, struct err *err);

/* Removes a file; a missing one is no error. */
bool file_remove(const char *path, struct err *err);

/* 128-bit XXH3 of the bytes, as 32 hexadecimal digits and a zero. */
void file_hash_bytes(char out[33], const void *data, size_t size);

/* The same of a file, which is read in pieces. Returns false, err set, when it is no regular file, cannot be read, or is longer than
 * `limit` bytes, of which then none is read: a file of holes can claim any length. */
bool file_hash(char out[33], const char *path, uint64_t limit, struct err *err);

/* Lists the names in folder `dir` (without its path), sorted by bytes; names that begin with a dot are left out. A missing folder
 * counts as empty. Returns false, err set, when it cannot be read. file_list_free. */
struct file_list {
	char **names;
	int n;
};
bool file_list(struct file_list *out, const char *dir, struct err *err);
void file_list_free(struct file_list *list);

/* True when `rel` is relative and without "..". Links are not followed here. */
bool file_is_relative(const char *rel);

/* The folder that a capture's links may lead into, of the environment's EYEWRIGHT_SOURCE: the capture itself, where WORK= has another
 * folder stand for it. Null where there is none. */
const char *file_source(void);

/* Whether `real`, a path without links, is the folder `root`, also without links, or below it or below file_source(). */
bool file_leads_inside(const char *real, const char *root);

/* Joins root and rel and resolves links: *out, free(). Returns false, err set and *out null, when rel is absolute or contains "..",
 * or when the result does not exist or lies outside `root` (file_leads_inside). */
bool file_inside(char **out, const char *root, const char *rel, struct err *err);

/* A temporary path in the folder of `path`, free(). The name is short whatever the length of `path`, and the same at every run,
 * so that a killed run leaves one file at most, which the next run overwrites or work_sweep (work.h) removes. */
char *file_temporary(const char *path);

/* Whether a name (without folders) is one that file_temporary gives. */
bool file_is_temporary(const char *name);

#ifdef __cplusplus
}
#endif
#endif
