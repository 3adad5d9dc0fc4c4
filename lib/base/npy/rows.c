#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "base/npy/head.h"

struct npy_rows {
	FILE *file;
	char *path, *buffer;
	struct npy_head head;
	size_t row;     // numbers in a row
	long left, room;  // rows not read yet; rows the buffer holds
};

static size_t row_length(const struct npy *array)
{
	size_t n = 1;
	for (int d = 1; d < array->ndim; d++)
		n *= (size_t)array->shape[d];
	return n;
}

static bool open_rows(struct npy_rows *rows, struct err *err)
{
	struct stat st;
	unsigned char *first = mem_array(NPY_HEAD_MAX + 12, 1);
	if (!rows->file || fstat(fileno(rows->file), &st) || !S_ISREG(st.st_mode)) {
		free(first);
		return err_set(err, "%s: %s", rows->path, rows->file ? "is not a regular file" : strerror(errno));
	}
	size_t got = fread(first, 1, NPY_HEAD_MAX + 12, rows->file);
	bool ok = npy_head_parse(&rows->head, first, got, rows->path, SIZE_MAX / 4, err);
	free(first);
	if (!ok)
		return false;
	const struct npy_head *h = &rows->head;
	if ((size_t)st.st_size - h->begins != h->bytes)
		return err_set(err, "%s: %zu bytes of numbers, must be %zu: cut off, or not what its head says", rows->path,
		               (size_t)st.st_size - h->begins, h->bytes);
	if (h->array.ndim < 1 || (h->fortran && h->array.ndim > 1))
		return err_set(err, "%s: must be row-major with at least one dimension", rows->path);
	rows->row = row_length(&h->array);
	rows->left = h->array.shape[0];
	return !fseeko(rows->file, (off_t)h->begins, SEEK_SET) || err_set(err, "%s: %s", rows->path, strerror(errno));
}

struct npy_rows *npy_rows_open(struct npy *head, const char *path, struct err *err)
{
	struct npy_rows *rows = mem_new(1, sizeof *rows);
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	rows->path = mem_str(path);
	rows->file = fd < 0 ? 0 : fdopen(fd, "rb");
	if (!open_rows(rows, err)) {
		npy_rows_close(rows);
		return 0;
	}
	*head = rows->head.array;
	return rows;
}

bool npy_rows_next(struct npy_rows *rows, long n, double *out, long *got, struct err *err)
{
	size_t size = npy_type_size(rows->head.array.type);
	n = n < rows->left ? n : rows->left;
	*got = 0;
	if (n > rows->room) {
		rows->buffer = mem_grow(rows->buffer, (size_t)n * rows->row + 1, size);
		rows->room = n;
	}
	size_t want = (size_t)n * rows->row;
	if (fread(rows->buffer, size, want, rows->file) != want)
		return err_set(err, "%s: cannot read", rows->path);
	if (rows->head.swapped)
		npy_swap(rows->buffer, want, size);
	npy_convert(out, rows->buffer, rows->head.array.type, want);
	rows->left -= n;
	*got = n;
	return true;
}

bool npy_rows_seek(struct npy_rows *rows, long first, struct err *err)
{
	size_t row = rows->row * npy_type_size(rows->head.array.type);
	if (first < 0 || first > rows->head.array.shape[0])
		return err_set(err, "%s: row %ld of %ld", rows->path, first, rows->head.array.shape[0]);
	rows->left = rows->head.array.shape[0] - first;
	return !fseeko(rows->file, (off_t)(rows->head.begins + (size_t)first * row), SEEK_SET)
	       || err_set(err, "%s: %s", rows->path, strerror(errno));
}

void npy_rows_close(struct npy_rows *rows)
{
	if (!rows)
		return;
	if (rows->file)
		fclose(rows->file);
	free(rows->buffer);
	free(rows->path);
	free(rows);
}

struct npy_sink {
	FILE *file;
	char *path, *tmp;
	struct npy array;
	size_t row;  // bytes
};

/* A name of its own beside `path`; a killed run leaves one behind, which the next overwrites. */
static char *beside(const char *path)
{
	const char *slash = strrchr(path, '/');
	char hash[33];
	file_hash_bytes(hash, path, strlen(path));
	return mem_printf("%.*s.%.16s.rows", slash ? (int)(slash - path + 1) : 0, path, hash);
}

struct npy_sink *npy_sink_open(const char *path, const struct npy *row, struct err *err)
{
	struct npy_sink *sink = mem_new(1, sizeof *sink);
	const char *slash = strrchr(path, '/');
	char *dir = slash && slash != path ? mem_printf("%.*s", (int)(slash - path), path) : 0;
	unsigned char head[NPY_HEAD_WRITTEN];
	sink->path = mem_str(path);
	sink->tmp = beside(path);
	sink->array = *row;
	sink->array.shape[0] = 0;
	sink->row = row_length(row) * npy_type_size(row->type);
	bool ok = !dir || file_mkdirs(dir, err);
	free(dir);
	int fd = ok ? open(sink->tmp, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666) : -1;
	sink->file = fd < 0 ? 0 : fdopen(fd, "wb");
	size_t begins = npy_head_write(head, &sink->array);
	if (ok && (!sink->file || fwrite(head, 1, begins, sink->file) != begins))
		ok = err_set(err, "%s: cannot write: %s", path, strerror(errno));
	if (ok)
		return sink;
	npy_sink_close(sink, false, err);
	return 0;
}

bool npy_sink_put(struct npy_sink *sink, long n, const void *data, struct err *err)
{
	size_t bytes = (size_t)n * sink->row;
	if (bytes && fwrite(data, 1, bytes, sink->file) != bytes)
		return err_set(err, "%s: cannot write: %s", sink->path, strerror(errno));
	sink->array.shape[0] += n;
	return true;
}

bool npy_sink_close(struct npy_sink *sink, bool keep, struct err *err)
{
	if (!sink)
		return true;
	unsigned char head[NPY_HEAD_WRITTEN];
	size_t begins = npy_head_write(head, &sink->array);
	bool ok = sink->file && keep;
	if (ok)
		ok = !fseeko(sink->file, 0, SEEK_SET) && fwrite(head, 1, begins, sink->file) == begins;
	if (sink->file && fclose(sink->file))
		ok = false;
	ok = ok && !rename(sink->tmp, sink->path);
	if (keep && !ok)
		err_set(err, "%s: cannot write: %s", sink->path, strerror(errno));
	if (sink->file && !ok)
		unlink(sink->tmp);
	free(sink->path);
	free(sink->tmp);
	free(sink);
	return ok || !keep;
}
