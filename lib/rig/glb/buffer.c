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

int glb_add_floats(struct glb_buffer *g, const float *x, size_t n, int width, bool range, int target)
{
	static const char *const types[] = { "", "SCALAR", "VEC2", "VEC3", "VEC4" };
	int view = glb_add_view(g, x, n * (size_t)width * sizeof *x, target);
	json_t *a = json_pack("{s:i,s:i,s:I,s:s}", "bufferView", view, "componentType", GLB_FLOAT, "count", (json_int_t)n, "type", types[width]);
	if (range)
		put_range(a, x, n, width);
	return glb_add_accessor(g, a);
}

int glb_add_sparse(struct glb_buffer *g, const float *x, int few, int index_view, int all, bool range)
{
	int view = glb_add_view(g, x, 3 * (size_t)few * sizeof *x, 0);
	json_t *a = json_pack("{s:i,s:i,s:s,s:{s:i,s:{s:i,s:i},s:{s:i}}}", "componentType", GLB_FLOAT, "count", all, "type", "VEC3", "sparse",
	                      "count", few, "indices", "bufferView", index_view, "componentType", GLB_UINT, "values", "bufferView", view);
	if (range) {
		float *with_zero = mem_new(3 * ((size_t)few + 1), sizeof *with_zero);
		memcpy(with_zero, x, 3 * (size_t)few * sizeof *x);
		put_range(a, with_zero, few < all ? (size_t)few + 1 : (size_t)few, 3);
		free(with_zero);
	}
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
