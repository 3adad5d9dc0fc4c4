#include "base/npy/head.h"

#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "arrays are written as they lie in memory");

/* NumPy's names without byte order. */
static const struct {
	char code[3];
	size_t size;
} types[] = {
	[NPY_F4] = { "f4", 4 }, [NPY_F8] = { "f8", 8 }, [NPY_I1] = { "i1", 1 }, [NPY_I2] = { "i2", 2 },
	[NPY_I4] = { "i4", 4 }, [NPY_I8] = { "i8", 8 }, [NPY_U1] = { "u1", 1 }, [NPY_U2] = { "u2", 2 },
	[NPY_U4] = { "u4", 4 }, [NPY_U8] = { "u8", 8 }, [NPY_BOOL] = { "b1", 1 },
};
_Static_assert(sizeof types / sizeof *types == NPY_TYPES, "one row for each type");

size_t npy_type_size(enum npy_type type)
{
	return types[type].size;
}

/* The value behind 'key': in the head's Python dictionary; null when it is not there. */
static const char *value_of(const char *text, const char *key)
{
	size_t n = strlen(key);
	for (const char *p = text; (p = strpbrk(p, "'\"")); p++) {
		if (strncmp(p + 1, key, n) || p[1 + n] != *p)
			continue;
		p += n + 2;
		p += strspn(p, " ");
		if (*p != ':')
			return 0;
		return p + 1 + strspn(p + 1, " ");
	}
	return 0;
}

static bool parse_type(struct npy_head *head, const char *text, const char *path, struct err *err)
{
	const char *v = value_of(text, "descr");
	if (!v || (*v != '\'' && *v != '"') || !v[1] || !v[2] || !v[3])
		return err_set(err, "%s: not an array of plain numbers", path);
	char order = v[1];
	for (int t = 0; t < NPY_TYPES; t++)
		if (strchr("<>|=", order) && !strncmp(v + 2, types[t].code, 2) && v[4] == *v) {
			head->array.type = (enum npy_type)t;
			head->swapped = order == '>' && types[t].size > 1;
			return true;
		}
	return err_set(err, "%s: numbers of type %.*s: must be integers or float32 or float64", path,
	               (int)strcspn(v + 1, "'\"\n") > 16 ? 16 : (int)strcspn(v + 1, "'\"\n"), v + 1);
}

static bool parse_shape(struct npy *array, const char *text, const char *path, struct err *err)
{
	const char *p = value_of(text, "shape");
	if (!p || *p++ != '(')
		return err_set(err, "%s: head without a shape", path);
	for (;;) {
		p += strspn(p, " ");
		if (*p == ')')
			return true;
		if (!isdigit((unsigned char)*p) || array->ndim == NPY_DIMS)
			return err_set(err, "%s: shape must be at most %d whole numbers", path, NPY_DIMS);
		long n = 0;
		for (; isdigit((unsigned char)*p); p++)
			if (__builtin_mul_overflow(n, 10, &n) || __builtin_add_overflow(n, *p - '0', &n))
				return err_set(err, "%s: shape beyond any memory", path);
		array->shape[array->ndim++] = n;
		p += *p == 'L';  // Python 2
		p += strspn(p, " ");
		if (*p == ',')
			p++;
		else if (*p != ')')
			return err_set(err, "%s: shape must be at most %d whole numbers", path, NPY_DIMS);
	}
}

bool npy_head_parse(struct npy_head *head, const unsigned char *bytes, size_t size, const char *path, size_t limit,
                    struct err *err)
{
	char text[NPY_HEAD_MAX + 1];
	*head = (struct npy_head){ 0 };
	if (size < 12 || memcmp(bytes, "\x93NUMPY", 6) || bytes[6] < 1 || bytes[6] > 3)
		return err_set(err, "%s: not an .npy file", path);
	size_t at = bytes[6] == 1 ? 10 : 12;
	size_t length = bytes[8] | (size_t)bytes[9] << 8;
	if (bytes[6] > 1)
		length |= (size_t)bytes[10] << 16 | (size_t)bytes[11] << 24;
	if (length > NPY_HEAD_MAX || length > size - at)
		return err_set(err, "%s: .npy head of %zu bytes in a file of %zu", path, length, size);
	memcpy(text, bytes + at, length);
	text[length] = 0;
	head->begins = at + length;
	if (!parse_type(head, text, path, err) || !parse_shape(&head->array, text, path, err))
		return false;
	const char *order = value_of(text, "fortran_order");
	if (!order || (strncmp(order, "True", 4) && strncmp(order, "False", 5)))
		return err_set(err, "%s: head without fortran_order", path);
	head->fortran = *order == 'T';
	head->bytes = types[head->array.type].size;
	size_t whole = head->bytes;  // dimensions of 0 counted as 1: rows of an empty array have a length too
	for (int d = 0; d < head->array.ndim; d++) {
		size_t n = (size_t)head->array.shape[d];
		if (__builtin_mul_overflow(whole, n ? n : 1, &whole) || whole > SIZE_MAX / 4)
			return err_set(err, "%s: shape beyond any memory", path);
		head->bytes *= n;
	}
	if (head->bytes > limit)
		return err_set(err, "%s: array of %zu bytes, must be <= %zu", path, head->bytes, limit);
	return true;
}

size_t npy_head_write(unsigned char out[NPY_HEAD_WRITTEN], const struct npy *array)
{
	char shape[NPY_DIMS * 22 + 2] = "";
	size_t n = 0;
	for (int d = 0; d < array->ndim; d++)
		n += (size_t)snprintf(shape + n, sizeof shape - n, "%s%ld", d ? ", " : "", array->shape[d]);
	if (array->ndim == 1)
		strcpy(shape + n, ",");
	char *text = (char *)out + 10;
	bool bytes = types[array->type].size == 1;
	int used = snprintf(text, NPY_HEAD_WRITTEN - 10, "{'descr': '%c%s', 'fortran_order': False, 'shape': (%s), }",
	                    bytes ? '|' : '<', types[array->type].code, shape);
	// NumPy's own room for a growing first dimension: 20 digits more.
	int digits = array->ndim ? snprintf(0, 0, "%ld", array->shape[0]) : 20;
	size_t length = (10 + (size_t)used + (size_t)(20 - digits) + 1 + 63) / 64 * 64;
	memset(text + used, ' ', length - 10 - (size_t)used);
	out[length - 1] = '\n';
	memcpy(out, "\x93NUMPY\1", 8);
	out[8] = (unsigned char)((length - 10) & 255);
	out[9] = (unsigned char)((length - 10) >> 8);
	return length;
}

void npy_swap(void *data, size_t n, size_t size)
{
	unsigned char *p = data;
	for (size_t i = 0; i < n; i++, p += size)
		for (size_t a = 0, b = size - 1; a < b; a++, b--) {
			unsigned char t = p[a];
			p[a] = p[b];
			p[b] = t;
		}
}

#define CONVERT(type) \
	for (size_t i = 0; i < n; i++) { \
		type x; \
		memcpy(&x, (const char *)data + i * sizeof x, sizeof x); \
		out[i] = (double)x; \
	} \
	return

void npy_convert(double *out, const void *data, enum npy_type type, size_t n)
{
	switch (type) {
	case NPY_F4: CONVERT(float);
	case NPY_F8: CONVERT(double);
	case NPY_I1: CONVERT(int8_t);
	case NPY_I2: CONVERT(int16_t);
	case NPY_I4: CONVERT(int32_t);
	case NPY_I8: CONVERT(int64_t);
	case NPY_U2: CONVERT(uint16_t);
	case NPY_U4: CONVERT(uint32_t);
	case NPY_U8: CONVERT(uint64_t);
	case NPY_U1:
	case NPY_BOOL: CONVERT(uint8_t);
	case NPY_TYPES: break;
	}
}
