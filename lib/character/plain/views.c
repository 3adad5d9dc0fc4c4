#include <meshoptimizer.h>
#include <string.h>

#include "character/plain/impl.h"

/* What a view is of: an extension's, or its own. */
struct piece {
	const char *bytes;
	size_t size;
};

static bool piece_of(struct piece *piece, struct gltf *gltf, const json_t *of, size_t view, gltf_load *load, void *ctx, struct err *err)
{
	size_t whole;
	const char *bytes = gltf_buffer(&whole, gltf, gltf_count(of, "buffer", -1, INT32_MAX), load, ctx, err);
	const long at = gltf_count(of, "byteOffset", 0, INT32_MAX), n = gltf_count(of, "byteLength", -1, INT32_MAX);
	if (!bytes)
		return false;
	if (at < 0 || n < 0 || (size_t)at > whole || (size_t)n > whole - (size_t)at)
		return err_set(err, "bufferViews[%zu] ends behind its buffer", view);
	*piece = (struct piece){ bytes + at, (size_t)n };
	return true;
}

static bool is_word(const json_t *of, const char *key, const char *word)
{
	const char *value = json_string_value(json_object_get(of, key));
	return value && !strcmp(value, word);
}

/* The decoders want room for whole elements and check their input; filters work in place. Returns false for what does not follow the extension's text. */
static bool decode(uint8_t *to, const struct piece *from, const json_t *packed, size_t n, size_t stride)
{
	const uint8_t *bytes = (const uint8_t *)from->bytes;
	if (is_word(packed, "mode", "TRIANGLES"))
		return n % 3 == 0 && (stride == 2 || stride == 4) && !meshopt_decodeIndexBuffer(to, n, stride, bytes, from->size);
	if (is_word(packed, "mode", "INDICES"))
		return (stride == 2 || stride == 4) && !meshopt_decodeIndexSequence(to, n, stride, bytes, from->size);
	if (!is_word(packed, "mode", "ATTRIBUTES") || stride % 4 || stride > 256 || meshopt_decodeVertexBuffer(to, n, stride, bytes, from->size))
		return false;
	if (is_word(packed, "filter", "OCTAHEDRAL")) {
		if (stride != 4 && stride != 8)
			return false;
		meshopt_decodeFilterOct(to, n, stride);
	} else if (is_word(packed, "filter", "QUATERNION")) {
		if (stride != 8)
			return false;
		meshopt_decodeFilterQuat(to, n, stride);
	} else if (is_word(packed, "filter", "EXPONENTIAL"))
		meshopt_decodeFilterExp(to, n, stride);
	return true;
}

bool gltf_unpack(struct gltf *gltf, gltf_load *load, void *ctx, struct err *err)
{
	size_t i;
	json_t *view;
	json_array_foreach(json_object_get(gltf->root, "bufferViews"), i, view) {
		const json_t *packed = gltf_packed(view);
		const long n = gltf_count(packed, "count", -1, INT32_MAX), stride = gltf_count(packed, "byteStride", -1, 256);
		struct piece from = { 0 };
		size_t at;
		if (packed && (n < 0 || stride < 1))
			return err_set(err, "bufferViews[%zu]: compressed without a count or a byteStride of 1 to 256", i);
		if (!piece_of(&from, gltf, packed ? packed : view, i, load, ctx, err))
			return false;
		const size_t size = packed ? (size_t)n * (size_t)stride : from.size;
		uint8_t *to = gltf_more(gltf, size, &at, err);
		if (!to)
			return false;
		if (!packed && size)
			memcpy(to, from.bytes, size);
		if (packed && n && !decode(to, &from, packed, (size_t)n, (size_t)stride))
			return err_set(err, "bufferViews[%zu]: damaged, or compressed by a newer meshoptimizer", i);
		json_object_set_new(view, "buffer", json_integer(0));
		json_object_set_new(view, "byteOffset", json_integer((json_int_t)at));
		json_object_set_new(view, "byteLength", json_integer((json_int_t)size));
		json_object_del(view, "extensions");
	}
	return true;
}
