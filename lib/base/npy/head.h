/* npy_head: the head of an .npy file: what numbers, how many, where they begin. Used by npy*.c alone. */
#ifndef BASE_NPY_HEAD_H
#define BASE_NPY_HEAD_H
#include "base/npy/npy.h"

enum { NPY_HEAD_MAX = 1 << 16 };

struct npy_head {
	struct npy array;   // type and shape; data null
	size_t begins;      // bytes before the first number
	size_t bytes;       // of all numbers
	bool swapped, fortran;
};

/* From the first `size` bytes of a file. False, err set, for what is no .npy head, or numbers beyond `limit` bytes. */
bool npy_head_parse(struct npy_head *head, const unsigned char *bytes, size_t size, const char *path, size_t limit,
                    struct err *err);

/* Head of an array in format 1.0, a multiple of 64 bytes. fixed: leaves room for any shape[0], so that the head of a
 * growing file keeps its length. Returns its length, at most NPY_HEAD_WRITTEN. */
enum { NPY_HEAD_WRITTEN = 256 };
size_t npy_head_write(unsigned char out[NPY_HEAD_WRITTEN], const struct npy *array);

/* n numbers of that type, bytes reversed. */
void npy_swap(void *data, size_t n, size_t size);

/* n numbers of `type` as double. */
void npy_convert(double *out, const void *data, enum npy_type type, size_t n);

#endif
