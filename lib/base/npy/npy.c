#include "base/npy/npy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/npy/head.h"

long npy_count(const struct npy *array)
{
	long n = 1;
	for (int d = 0; d < array->ndim; d++)
		n *= array->shape[d];
	return n;
}

struct npy npy_of(enum npy_type type, int ndim, const long *shape, const void *data)
{
	struct npy array = { .type = type, .ndim = ndim };
	memcpy(array.shape, shape, (size_t)ndim * sizeof *shape);
	memcpy(&array.data, &data, sizeof data);  // written from, never to
	return array;
}

void npy_free(struct npy *array)
{
	free(array->data);
	*array = (struct npy){ 0 };
}

/* Column-major numbers into row-major order. */
static void *reordered(const struct npy *array, const char *from)
{
	size_t size = npy_type_size(array->type), n = (size_t)npy_count(array);
	char *to = mem_array(n, size);
	long at[NPY_DIMS] = { 0 };
	for (size_t i = 0; i < n; i++) {
		size_t place = 0;
		for (int d = 0; d < array->ndim; d++)
			place = place * (size_t)array->shape[d] + (size_t)at[d];
		memcpy(to + place * size, from + i * size, size);
		for (int d = 0; d < array->ndim && ++at[d] == array->shape[d]; d++)
			at[d] = 0;
	}
	return to;
}

bool npy_parse(struct npy *out, const void *bytes, size_t size, const char *path, size_t limit, struct err *err)
{
	struct npy_head head;
	*out = (struct npy){ 0 };
	if (!npy_head_parse(&head, bytes, size, path, limit, err))
		return false;
	if (size - head.begins != head.bytes)
		return err_set(err, "%s: %zu bytes of numbers, must be %zu: cut off, or not what its head says", path,
		               size - head.begins, head.bytes);
	const char *from = (const char *)bytes + head.begins;
	*out = head.array;
	if (head.fortran && head.array.ndim > 1)
		out->data = reordered(&head.array, from);
	else {
		out->data = mem_array(head.bytes + 1, 1);
		memcpy(out->data, from, head.bytes);
	}
	size_t one = npy_type_size(out->type);
	if (head.swapped)
		npy_swap(out->data, head.bytes / one, one);
	return true;
}

bool npy_read(struct npy *out, const char *path, size_t limit, struct err *err)
{
	char *bytes;
	size_t size;
	*out = (struct npy){ 0 };
	if (!file_read(&bytes, &size, path, limit + NPY_HEAD_MAX + 12, err))
		return false;
	bool ok = npy_parse(out, bytes, size, path, limit, err);
	free(bytes);
	return ok;
}

bool npy_save(const char *path, const struct npy *array, struct err *err)
{
	size_t bytes = (size_t)npy_count(array) * npy_type_size(array->type);
	unsigned char head[NPY_HEAD_WRITTEN];
	const struct file_part parts[] = { { head, npy_head_write(head, array) }, { array->data, bytes } };
	return file_write_parts(path, COUNT(parts), parts, err);
}

static void print_shape(char out[160], int ndim, const long *shape)
{
	size_t n = (size_t)snprintf(out, 160, "(");
	for (int d = 0; d < ndim; d++)
		n += (size_t)(shape[d] < 0 ? snprintf(out + n, 160 - n, "%sn", d ? ", " : "")
		                           : snprintf(out + n, 160 - n, "%s%ld", d ? ", " : "", shape[d]));
	snprintf(out + n, 160 - n, ")");
}

bool npy_expect(const struct npy *array, const char *path, int ndim, const long *shape, struct err *err)
{
	bool same = array->ndim == ndim;
	for (int d = 0; d < ndim && same; d++)
		same = shape[d] < 0 || shape[d] == array->shape[d];
	if (same)
		return true;
	char is[160], must[160];
	print_shape(is, array->ndim, array->shape);
	print_shape(must, ndim, shape);
	return err_set(err, "%s: shape %s, must be %s", path, is, must);
}

bool npy_in_range(const struct npy *array, double most, bool gaps, long first, const char *path, struct err *err)
{
	const float *f = array->type == NPY_F4 ? array->data : 0;
	const double *d = array->type == NPY_F8 ? array->data : 0;
	const long n = f || d ? npy_count(array) : 0;
	for (long i = 0; i < n; i++) {
		const double x = f ? (double)f[i] : d[i];
		if (!(fabs(x) <= most) && !(gaps && isnan(x)))
			return err_set(err, "%s: number %ld = %g: must be in [%g, %g]%s", path, first + i, x, -most, most,
			               gaps ? ", or NaN where it was not measured" : "");
	}
	return true;
}

double *npy_doubles(const struct npy *array)
{
	size_t n = (size_t)npy_count(array);
	double *out = mem_array(n + 1, sizeof *out);
	npy_convert(out, array->data, array->type, n);
	return out;
}
