#include "rig/glb/buffer.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

size_t glb_add_bytes(struct glb_buffer *g, const void *data, size_t size)
{
	size_t at = (g->size + 3) & ~(size_t)3;
	if (at + size + 4 > g->room)
		g->bin = mem_grow(g->bin, g->room = 2 * (at + size) + 1024, 1);
	memset(g->bin + g->size, 0, at - g->size);
	memcpy(g->bin + at, data, size);
	g->size = at + size;
	return at;
}

int glb_add_view(struct glb_buffer *g, const void *data, size_t size, int target)
{
	const size_t at = glb_add_bytes(g, data, size);
	json_t *view = json_pack("{s:i,s:I,s:I}", "buffer", 0, "byteOffset", (json_int_t)at, "byteLength", (json_int_t)size);
	if (target)
		json_object_set_new(view, "target", json_integer(target));
	json_array_append_new(g->views, view);
	return (int)json_array_size(g->views) - 1;
}

int glb_add_accessor(struct glb_buffer *g, json_t *accessor)
{
	json_array_append_new(g->accessors, accessor);
	return (int)json_array_size(g->accessors) - 1;
}

/* Smallest and largest of n rows of `width` numbers; floats exactly as the file has them. */
static void put_range(json_t *accessor, const float *x, size_t n, int width)
{
	json_t *low = json_array(), *high = json_array();
	for (int c = 0; c < width; c++) {
		float a = x[c], b = x[c];
		for (size_t i = 1; i < n; i++) {
			a = fminf(a, x[i * (size_t)width + (size_t)c]);
			b = fmaxf(b, x[i * (size_t)width + (size_t)c]);
		}
		json_array_append_new(low, json_real(a));
		json_array_append_new(high, json_real(b));
	}
	json_object_set_new(accessor, "min", low);
	json_object_set_new(accessor, "max", high);
}

int glb_add_shares(struct glb_buffer *g, const float *x, size_t n)
{
	int16_t *step = mem_new(n + 1, sizeof *step);
	for (size_t i = 0; i < n; i++)
		step[i] = (int16_t)lrintf(INT16_MAX * fminf(fmaxf(x[i], -1), 1));
	const int view = glb_add_view(g, step, n * sizeof *step, 0);
	free(step);
	return glb_add_accessor(g, json_pack("{s:i,s:i,s:b,s:I,s:s}", "bufferView", view, "componentType", GLB_SHORT, "normalized", 1, "count", (json_int_t)n, "type", "SCALAR"));
}

int glb_add_floats(struct glb_buffer *g, const float *x, size_t n, int width, bool range, int target)
{
	static const char *const types[] = { "", "SCALAR", "VEC2", "VEC3", "VEC4" };
	int view = glb_add_view(g, x, n * (size_t)width * sizeof *x, target);
	json_t *a = json_pack("{s:i,s:i,s:I,s:s}", "bufferView", view, "componentType", GLB_FLOAT, "count", (json_int_t)n, "type", types[width]);
	if (range)
		put_range(a, x, n, width);
	return glb_add_accessor(g, a);
}

/* Numbers of vertices take two bytes where there are few. */
static int row_type(int all)
{
	return all <= UINT16_MAX ? GLB_USHORT : GLB_UINT;
}

/* free(); size: out, bytes. */
static void *rows_packed(size_t *size, const uint32_t *row, size_t n, int all)
{
	const size_t each = row_type(all) == GLB_USHORT ? sizeof(uint16_t) : sizeof *row;
	char *bytes = mem_new(n * each + 1, 1);
	for (size_t i = 0; i < n; i++) {
		const uint16_t half = (uint16_t)row[i];
		memcpy(bytes + i * each, each == sizeof half ? (const void *)&half : (const void *)&row[i], each);
	}
	*size = n * each;
	return bytes;
}

int glb_add_corners(struct glb_buffer *g, const uint32_t *corner, size_t n, int all)
{
	size_t size;
	void *bytes = rows_packed(&size, corner, n, all);
	const int view = glb_add_view(g, bytes, size, GLB_INDICES);
	free(bytes);
	return glb_add_accessor(g, json_pack("{s:i,s:i,s:I,s:s}", "bufferView", view, "componentType", row_type(all), "count", (json_int_t)n, "type", "SCALAR"));
}

int glb_add_rows(struct glb_buffer *g, const uint32_t *row, int few, int all)
{
	size_t size;
	void *bytes = rows_packed(&size, row, (size_t)few, all);
	const json_t *view = json_array_get(g->views, (size_t)g->rows_view);
	if (!size || g->rows_size != size || memcmp(g->bin + json_integer_value(json_object_get(view, "byteOffset")), bytes, size) != 0) {
		g->rows_view = glb_add_view(g, bytes, size, 0);
		g->rows_size = size;
	}
	free(bytes);
	return g->rows_view;
}

int glb_add_normals(struct glb_buffer *g, const float (*normal)[3], size_t n)
{
	enum { STRIDE = 4 };  // attributes of vertices begin at multiples of four
	int8_t *bytes = mem_new(STRIDE * n + 1, 1);
	for (size_t i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			bytes[STRIDE * i + (size_t)c] = (int8_t)lrintf(127 * fminf(fmaxf(normal[i][c], -1), 1));
	const int view = glb_add_view(g, bytes, STRIDE * n, GLB_ARRAY);
	json_object_set_new(json_array_get(g->views, (size_t)view), "byteStride", json_integer(STRIDE));
	free(bytes);
	return glb_add_accessor(g, json_pack("{s:i,s:i,s:b,s:I,s:s}", "bufferView", view, "componentType", GLB_BYTE, "normalized", 1, "count", (json_int_t)n, "type", "VEC3"));
}

static json_t *sparse(int type, int few, int rows_view, int view, int all)
{
	return json_pack("{s:i,s:i,s:s,s:{s:i,s:{s:i,s:i},s:{s:i}}}", "componentType", type, "count", all, "type", "VEC3", "sparse", "count", few, "indices",
	                 "bufferView", rows_view, "componentType", row_type(all), "values", "bufferView", view);
}

int glb_add_sparse(struct glb_buffer *g, const float *x, int few, int rows_view, int all)
{
	json_t *a = sparse(GLB_FLOAT, few, rows_view, glb_add_view(g, x, 3 * (size_t)few * sizeof *x, 0), all);
	float *with_zero = mem_new(3 * ((size_t)few + 1), sizeof *with_zero);
	memcpy(with_zero, x, 3 * (size_t)few * sizeof *x);
	put_range(a, with_zero, few < all ? (size_t)few + 1 : (size_t)few, 3);
	free(with_zero);
	return glb_add_accessor(g, a);
}

/* Of whole numbers: as they are in the buffer, whatever they stand for. */
static void put_step_range(json_t *accessor, const int16_t *step, int few, bool zero)
{
	json_t *low = json_array(), *high = json_array();
	for (int c = 0; c < 3; c++) {
		int a = zero ? 0 : step[c], b = a;
		for (int i = 0; i < few; i++) {
			a = step[3 * i + c] < a ? step[3 * i + c] : a;
			b = step[3 * i + c] > b ? step[3 * i + c] : b;
		}
		json_array_append_new(low, json_integer(a));
		json_array_append_new(high, json_integer(b));
	}
	json_object_set_new(accessor, "min", low);
	json_object_set_new(accessor, "max", high);
}

int glb_add_sparse_steps(struct glb_buffer *g, const int16_t *step, int few, int rows_view, int all, int bits, bool range)
{
	int8_t *bytes = mem_new(3 * (size_t)few + 1, 1);
	for (int i = 0; i < 3 * few; i++)
		bytes[i] = (int8_t)step[i];
	const int view = bits == 8 ? glb_add_view(g, bytes, 3 * (size_t)few, 0) : glb_add_view(g, step, 3 * (size_t)few * sizeof *step, 0);
	json_t *a = sparse(bits == 8 ? GLB_BYTE : GLB_SHORT, few, rows_view, view, all);
	json_object_set_new(a, "normalized", json_true());
	if (range)
		put_step_range(a, step, few, few < all);
	free(bytes);
	return glb_add_accessor(g, a);
}

bool glb_pack(char **packed, size_t *size, const struct glb_buffer *g, const json_t *root, struct err *err)
{
	char *text = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(9));
	size_t json_size = strlen(text), json_pad = (json_size + 3) & ~(size_t)3, bin_pad = (g->size + 3) & ~(size_t)3;
	size_t total = 12 + 8 + json_pad + 8 + bin_pad;
	*packed = 0;
	*size = total;
	if (total >= UINT32_MAX) {
		free(text);
		return err_set(err, "larger than a binary glTF can be (4 GiB)");
	}
	char *at = *packed = mem_array(total, 1);
	uint32_t head[5] = { GLB_MAGIC, 2, (uint32_t)total, (uint32_t)json_pad, 0x4e4f534a }, bin[2] = { (uint32_t)bin_pad, 0x004e4942 };
	memset(at, 0, total);
	memcpy(at, head, sizeof head);
	at += sizeof head;
	memcpy(at, text, json_size);
	memset(at + json_size, ' ', json_pad - json_size);
	at += json_pad;
	memcpy(at, bin, sizeof bin);
	memcpy(at + sizeof bin, g->bin, g->size);
	free(text);
	return true;
}

bool glb_save(const char *path, const struct glb_buffer *g, const json_t *root, long *bytes, struct err *err)
{
	char *out;
	size_t size;
	bool ok = glb_pack(&out, &size, g, root, err) ? file_write(path, out, size, err) : err_wrap(err, "%s", path);
	*bytes = (long)size;
	free(out);
	return ok;
}
