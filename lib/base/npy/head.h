/* head: the header of an .npy file: type, shape, and where the numbers begin. For the files of this folder alone. */
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

/* Parses the header from the first `size` bytes of a file; path stands in messages. Returns false, err set, when they are no .npy
 * header, or when the numbers would take more than `limit` bytes. */
bool npy_head_parse(struct npy_head *head, const unsigned char *bytes, size_t size, const char *path, size_t limit,
                    struct err *err);

/* Writes the header of an array in format 1.0. Its length, which is returned, is a multiple of 64 bytes, at most
 * NPY_HEAD_WRITTEN, and does not depend on shape[0]. */
enum { NPY_HEAD_WRITTEN = 256 };
size_t npy_head_write(unsigned char out[NPY_HEAD_WRITTEN], const struct npy *array);

/* Reverses the bytes of each of n numbers of `size` bytes. */
void npy_swap(void *data, size_t n, size_t size);

/* Converts n numbers of `type` to double: out[n]. */
void npy_convert(double *out, const void *data, enum npy_type type, size_t n);

#endif
