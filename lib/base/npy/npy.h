/* npy: arrays of numbers in NumPy's files: .npy (formats 1.0 to 3.0) and .npz (a zip of them, stored or deflated).
 * In memory arrays are row-major and in this machine's byte order, whatever the file has. Written: format 1.0, little endian,
 * row-major, no dates: equal arrays give equal bytes.
 * Files are not trusted: a header whose size does not fit the file, an unknown type, Python objects, and an array larger than
 * `limit` bytes are errors before any memory is taken for them.
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

/* Bytes of one number. */
size_t npy_type_size(enum npy_type type);
/* Numbers in the array: the product of its shape. */
long npy_count(const struct npy *array);

/* An array for npy_save that refers to the caller's memory: npy_of(NPY_F4, 2, (long[]){ n, 2 }, px). Not to be freed. */
struct npy npy_of(enum npy_type type, int ndim, const long *shape, const void *data);
void npy_free(struct npy *array);

/* Read and write whole files; npy_parse reads the bytes of one, path standing in its messages. Return false, err set, on failure:
 * out is empty then. npy_free. */
bool npy_read(struct npy *out, const char *path, size_t limit, struct err *err);
bool npy_parse(struct npy *out, const void *bytes, size_t size, const char *path, size_t limit, struct err *err);
bool npy_save(const char *path, const struct npy *array, struct err *err);

/* Whether the array has the shape shape[ndim] (−1: any); if not, err is set: "path: shape (3, 4), must be (n, 2)". */
bool npy_expect(const struct npy *array, const char *path, int ndim, const long *shape, struct err *err);

/* Whether its floating-point numbers are within [-most, most] or, with gaps, NAN: not measured. If not, err is set: "path: number 12
 * = inf: must be ...", counted from `first`, that of the array's first. Integers pass. */
bool npy_in_range(const struct npy *array, double most, bool gaps, long first, const char *path, struct err *err);

/* A copy of the numbers as double, row-major; free(). Integers beyond 2^53 are rounded. */
double *npy_doubles(const struct npy *array);

/* Reads the array `name` (without ".npy") of an .npz file. Returns false, err set, when it is missing or cannot be read.
 * npy_free. */
bool npz_read(struct npy *out, const char *path, const char *name, size_t limit, struct err *err);

/* Whether the file can be read and has an array of that name. */
bool npz_has(const char *path, const char *name, size_t limit);

struct npz_item {
	const char *name;
	struct npy array;
};
/* Writes an .npz file. made_by: text kept in the zip as made_by.json, or null. Returns false, err set, when it cannot be written.
 * */
bool npz_save(const char *path, int n, const struct npz_item items[], const char *made_by, struct err *err);

/* Reads the rows of a large .npy file block by block, in memory that does not grow with the file. A row is one index of the first
 * dimension. Fortran-ordered files are refused, since their rows are not contiguous.
 * head  out: type and shape; data null
 * Returns null, err set, on failure. npy_rows_close. */
struct npy_rows;
struct npy_rows *npy_rows_open(struct npy *head, const char *path, struct err *err);
/* Reads the next n rows, fewer at the end, as double: out[n][row length]; *got: how many, 0 at the end. */
bool npy_rows_next(struct npy_rows *rows, long n, double *out, long *got, struct err *err);
/* Makes row `first` the next one to be read. */
bool npy_rows_seek(struct npy_rows *rows, long first, struct err *err);
void npy_rows_close(struct npy_rows *rows);

#ifdef __cplusplus
}
#endif
#endif
