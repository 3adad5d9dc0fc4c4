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
