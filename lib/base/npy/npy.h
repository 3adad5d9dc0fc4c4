/* npy: arrays of numbers in NumPy's files: .npy (formats 1.0 to 3.0) and .npz (a zip of them, stored or deflated).
 * In memory always row-major and in this machine's byte order, whatever the file has. Written: format 1.0, little
 * endian, row-major, no dates: equal arrays give equal bytes.
 * Files are strangers': a header that lies about its size, an unknown type, objects, an array larger than `limit` bytes
 * are refused in one line before any memory is taken for them.
 */
#ifndef BASE_NPY_NPY_H
#define BASE_NPY_NPY_H
#include <stddef.h>

#include "base/err.h"

#ifdef __cplusplus
extern "C" {
#endif

enum npy_type { NPY_F4, NPY_F8, NPY_I1, NPY_I2, NPY_I4, NPY_I8, NPY_U1, NPY_U2, NPY_U4, NPY_U8, NPY_BOOL, NPY_TYPES };
enum { NPY_DIMS = 6 };
static const size_t NPY_LIMIT = (size_t)2 << 30;  // bytes of one array, for callers without a reason of their own

struct npy {
	enum npy_type type;
	int ndim;
	long shape[NPY_DIMS];
	void *data;  // npy_free when read; may be the caller's own when written
};

size_t npy_type_size(enum npy_type type);
long npy_count(const struct npy *array);

/* A view of the caller's memory, to be written. npy_of(NPY_F4, 2, (long[]){ n, 2 }, px). */
struct npy npy_of(enum npy_type type, int ndim, const long *shape, const void *data);
void npy_free(struct npy *array);

/* Whole files. path stands in messages. */
bool npy_read(struct npy *out, const char *path, size_t limit, struct err *err);
bool npy_parse(struct npy *out, const void *bytes, size_t size, const char *path, size_t limit, struct err *err);
bool npy_save(const char *path, const struct npy *array, struct err *err);

/* True when the array has these dimensions (−1: any); else err: "path: shape (3, 4), must be (n, 2)". */
bool npy_expect(const struct npy *array, const char *path, int ndim, const long *shape, struct err *err);

/* The numbers as double, row-major; free(). Integers beyond 2^53 are rounded. */
double *npy_doubles(const struct npy *array);

/* The array NAME (without ".npy") of an .npz file. A missing one: err. */
bool npz_read(struct npy *out, const char *path, const char *name, size_t limit, struct err *err);

struct npz_item {
	const char *name;
	struct npy array;
};
/* made_by: text kept in the zip as made_by.json, or null. */
bool npz_save(const char *path, int n, const struct npz_item items[], const char *made_by, struct err *err);

/* Rows of a large .npy one block after another, in memory that does not grow with the file. A row is what one step of
 * the first dimension holds. Fortran-ordered files are refused (their rows are not together). */
struct npy_rows;
struct npy_rows *npy_rows_open(struct npy *head, const char *path, struct err *err);  // head: shape and type, data null
/* Next at most n rows as double [rows][row length]; *got = 0 at the end. */
bool npy_rows_next(struct npy_rows *rows, long n, double *out, long *got, struct err *err);
/* The next row read is row `first`. */
bool npy_rows_seek(struct npy_rows *rows, long first, struct err *err);
void npy_rows_close(struct npy_rows *rows);

#ifdef __cplusplus
}
#endif
#endif
