#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "character/plain/impl.h"

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

static int number_bytes(const json_t *accessor)
{
	switch (gltf_count(accessor, "componentType", 0, INT32_MAX)) {
	case BYTE:
	case UNSIGNED_BYTE:
		return 1;
	case SHORT:
	case UNSIGNED_SHORT:
		return 2;
	case UNSIGNED_INT:
	case FLOAT:
		return 4;
	default:
		return 0;
	}
}

int gltf_components(const json_t *accessor)
{
	static const struct { const char *type; int n; } known[] = { { "SCALAR", 1 }, { "VEC2", 2 }, { "VEC3", 3 }, { "VEC4", 4 } };
	const char *type = json_string_value(json_object_get(accessor, "type"));
	for (int i = 0; type && i < COUNT(known); i++)
		if (!strcmp(type, known[i].type))
			return known[i].n;
	return 0;
}

/* Calls `each` with every attribute of every primitive and its targets, but joints, and but what Draco has, which the reader unpacks. */
static bool each_attribute(const struct gltf *gltf, bool (*each)(void *ctx, long accessor), void *ctx)
{
	size_t m, p, t;
	json_t *mesh, *primitive, *target, *value;
	const char *name;
	json_array_foreach(json_object_get(gltf->root, "meshes"), m, mesh)
		json_array_foreach(json_object_get(mesh, "primitives"), p, primitive) {
			if (gltf_extension(primitive, "KHR_draco_mesh_compression"))
				continue;
			json_object_foreach(json_object_get(primitive, "attributes"), name, value)
				if (strncmp(name, "JOINTS_", 7) && json_is_integer(value) && !each(ctx, (long)json_integer_value(value)))
					return false;
			json_array_foreach(json_object_get(primitive, "targets"), t, target)
				json_object_foreach(target, name, value)
					if (json_is_integer(value) && !each(ctx, (long)json_integer_value(value)))
						return false;
		}
	return true;
}

static bool is_float(void *ctx, long i)
{
	const json_t *accessor = gltf_item(ctx, "accessors", i);
	return !accessor || gltf_count(accessor, "componentType", FLOAT, INT32_MAX) == FLOAT;
}

bool gltf_is_quantised(const struct gltf *gltf)
{
	return !each_attribute(gltf, is_float, (void *)gltf);
}

/* One number of an accessor (glTF 2.0, 3.6.2.2: whole numbers that stand for -1 to 1). */
static float number(const uint8_t *p, long type, bool normalised)
{
	switch (type) {
	case BYTE:
		return normalised ? fmaxf((float)(int8_t)*p / 127, -1) : (float)(int8_t)*p;
	case UNSIGNED_BYTE:
		return normalised ? (float)*p / 255 : (float)*p;
	case SHORT: {
		int16_t x;
		memcpy(&x, p, sizeof x);
		return normalised ? fmaxf((float)x / 32767, -1) : (float)x;
	}
	case UNSIGNED_SHORT: {
		uint16_t x;
		memcpy(&x, p, sizeof x);
		return normalised ? (float)x / 65535 : (float)x;
	}
	case UNSIGNED_INT: {
		uint32_t x;
		memcpy(&x, p, sizeof x);
		return (float)x;
	}
	default: {
		float x;
		memcpy(&x, p, sizeof x);
		return x;
	}
	}
}

bool gltf_rows(struct gltf_rows *rows, const struct gltf *gltf, const json_t *of, size_t element, long n, long accessor, struct err *err)
{
	const json_t *view = gltf_item(gltf, "bufferViews", gltf_count(of, "bufferView", -1, INT32_MAX));
	const long start = gltf_count(view, "byteOffset", 0, INT32_MAX), length = gltf_count(view, "byteLength", -1, INT32_MAX),
	           stride = gltf_count(view, "byteStride", (long)element, 256), at = gltf_count(of, "byteOffset", 0, INT32_MAX);
	if (!view || start < 0 || length < 0 || at < 0 || stride < (long)element || (size_t)(start + length) > gltf->size)
		return err_set(err, "accessors[%ld]: no such bufferView", accessor);
	if (n > 0 && at + (n - 1) * stride + (long)element > length)
		return err_set(err, "accessors[%ld] ends behind its bufferView", accessor);
	*rows = (struct gltf_rows){ (size_t)(start + at), (size_t)stride };
	return true;
}

/* The elements of an accessor that stand elsewhere (sparse accessors). out: [n][c]. */
static bool put_sparse(float *out, const struct gltf *gltf, const json_t *accessor, long i, long n, int c, int bytes, struct err *err)
{
	const json_t *sparse = json_object_get(accessor, "sparse"), *where = json_object_get(sparse, "indices"), *values = json_object_get(sparse, "values");
	if (!sparse)
		return true;
	const long few = gltf_count(sparse, "count", -1, n), type = gltf_count(accessor, "componentType", 0, INT32_MAX), index_type = gltf_count(where, "componentType", 0, INT32_MAX);
	const int index_bytes = number_bytes(where);
	struct gltf_rows at, value;
	if (few < 0 || !index_bytes)
		return err_set(err, "accessors[%ld]: its sparse elements cannot be counted", i);
	if (!gltf_rows(&at, gltf, where, (size_t)index_bytes, few, i, err) || !gltf_rows(&value, gltf, values, (size_t)(c * bytes), few, i, err))
		return false;
	for (long k = 0; k < few; k++) {
		const double to = (double)number(gltf->blob + at.at + (size_t)k * at.stride, index_type, false);
		if (!(to >= 0 && to < (double)n))
			return err_set(err, "accessors[%ld]: sparse element %.0f of %ld", i, to, n);
		for (int d = 0; d < c; d++)
			out[(long)to * c + d] = number(gltf->blob + value.at + (size_t)k * value.stride + (size_t)(d * bytes), type, json_is_true(json_object_get(accessor, "normalized")));
	}
	return true;
}

/* A view of n floats at the new buffer's end. Its index in bufferViews; -1, err set. */
static int new_view(float **to, struct gltf *gltf, size_t n, struct err *err)
{
	size_t at;
	uint8_t *room = gltf_more(gltf, n * sizeof **to, &at, err);
	if (!room)
		return -1;
	*to = (float *)(void *)room;
	json_t *views = json_object_get(gltf->root, "bufferViews");
	if (!json_is_array(views)) {
		views = json_array();
		json_object_set_new(gltf->root, "bufferViews", views);
	}
	json_array_append_new(views, json_pack("{sisIsI}", "buffer", 0, "byteOffset", (json_int_t)at, "byteLength", (json_int_t)(n * sizeof **to)));
	return (int)json_array_size(views) - 1;
}

float *gltf_new_floats(int *index, struct gltf *gltf, const char *type, long n, int c, struct err *err)
{
	float *to;
	const int view = new_view(&to, gltf, (size_t)n * (size_t)c, err);
	if (view < 0)
		return 0;
	json_t *accessors = json_object_get(gltf->root, "accessors");
	json_array_append_new(accessors, json_pack("{sisisssI}", "bufferView", view, "componentType", FLOAT, "type", type, "count", (json_int_t)n));
	*index = (int)json_array_size(accessors) - 1;
	return to;
}

struct floats {
	struct gltf *gltf;
	struct err *err;
};

static bool make_float(void *ctx, long i)
{
	const struct floats *f = ctx;
	struct gltf *gltf = f->gltf;
	json_t *accessor = gltf_item(gltf, "accessors", i);
	if (is_float(gltf, i))
		return true;
	const long n = gltf_count(accessor, "count", -1, INT32_MAX), type = gltf_count(accessor, "componentType", 0, INT32_MAX);
	const int c = gltf_components(accessor), bytes = number_bytes(accessor);
	const bool normalised = json_is_true(json_object_get(accessor, "normalized")), dense = json_object_get(accessor, "bufferView");
	if (n < 0 || !c || !bytes)
		return err_set(f->err, "accessors[%ld]: neither floats nor whole numbers", i);
	struct gltf_rows rows = { 0 };
	if (dense && !gltf_rows(&rows, gltf, accessor, (size_t)(c * bytes), n, i, f->err))
		return false;
	float *to;
	const int view = new_view(&to, gltf, (size_t)n * (size_t)c, f->err);
	if (view < 0)
		return false;
	for (long k = 0; dense && k < n; k++)
		for (int d = 0; d < c; d++)
			to[k * c + d] = number(gltf->blob + rows.at + (size_t)k * rows.stride + (size_t)(d * bytes), type, normalised);
	if (!put_sparse(to, gltf, accessor, i, n, c, bytes, f->err))
		return false;
	json_object_set_new(accessor, "bufferView", json_integer(view));
	json_object_set_new(accessor, "componentType", json_integer(FLOAT));
	static const char *const gone[] = { "byteOffset", "normalized", "sparse", "min", "max" };
	for (int k = 0; k < COUNT(gone); k++)
		json_object_del(accessor, gone[k]);
	return true;
}

bool gltf_floats(struct gltf *gltf, struct err *err)
{
	struct floats f = { gltf, err };
	return each_attribute(gltf, make_float, &f);
}
