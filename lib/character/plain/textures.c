#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "character/plain/impl.h"

static const char TRANSFORM[] = "KHR_texture_transform";

/* The textures of a material, as its members name them. */
enum { SLOTS = 5 };
static json_t *slot(const json_t *material, int i)
{
	const json_t *rough = json_object_get(material, "pbrMetallicRoughness");
	switch (i) {
	case 0:
		return json_object_get(rough, "baseColorTexture");
	case 1:
		return json_object_get(material, "normalTexture");
	case 2:
		return json_object_get(rough, "metallicRoughnessTexture");
	case 3:
		return json_object_get(material, "emissiveTexture");
	default:
		return json_object_get(material, "occlusionTexture");
	}
}

static json_t *other_picture(const json_t *texture)
{
	json_t *webp = gltf_extension(texture, "EXT_texture_webp");
	return webp ? webp : gltf_extension(texture, "KHR_texture_basisu");
}

bool gltf_has_textures(const struct gltf *gltf)
{
	size_t i;
	json_t *item;
	json_array_foreach(json_object_get(gltf->root, "textures"), i, item)
		if (other_picture(item) && !json_object_get(item, "source"))
			return true;
	json_array_foreach(json_object_get(gltf->root, "materials"), i, item)
		for (int s = 0; s < SLOTS; s++)
			if (gltf_extension(slot(item, s), TRANSFORM))
				return true;
	return false;
}

/* u' = m (u, v, 1). */
struct transform {
	double m[2][3];
	bool is;
};

static double member(const json_t *of, const char *key, int i, double otherwise)
{
	const json_t *value = json_object_get(of, key);
	value = i < 0 ? value : json_array_get(value, (size_t)i);
	return json_is_number(value) && isfinite(json_number_value(value)) ? json_number_value(value) : otherwise;
}

/* Offset after rotation after scale; the rotation is counter-clockwise as the picture is seen, v downwards. */
static struct transform transform_of(const json_t *material)
{
	for (int s = 0; s < SLOTS; s++) {
		const json_t *info = slot(material, s), *t = gltf_extension(info, TRANSFORM);
		if (!info || gltf_count(t, "texCoord", gltf_count(info, "texCoord", 0, 16), 16) != 0)
			continue;
		const double a = member(t, "rotation", -1, 0), sx = member(t, "scale", 0, 1), sy = member(t, "scale", 1, 1);
		struct transform out = { { { cos(a) * sx, sin(a) * sy, member(t, "offset", 0, 0) }, { -sin(a) * sx, cos(a) * sy, member(t, "offset", 1, 0) } }, t != 0 };
		return out;
	}
	return (struct transform){ .is = false };
}

/* Each pair of coordinates and material that was transformed: primitives share both. */
struct moved {
	long accessor, material;
	int to;
};

static bool move_coordinates(int *to, struct gltf *gltf, long i, const struct transform *t, struct err *err)
{
	const json_t *accessor = gltf_item(gltf, "accessors", i);
	const long n = gltf_count(accessor, "count", -1, INT32_MAX);
	struct gltf_rows rows;
	// Sparse coordinates, which no exporter writes, stay as they are.
	*to = (int)i;
	if (gltf_components(accessor) != 2 || json_object_get(accessor, "sparse") || !json_object_get(accessor, "bufferView"))
		return true;
	if (n < 0)
		return err_set(err, "accessors[%ld]: its elements cannot be counted", i);
	if (!gltf_rows(&rows, gltf, accessor, 2 * sizeof(float), n, i, err))
		return false;
	float *out = gltf_new_floats(to, gltf, "VEC2", n, 2, err);
	for (long k = 0; out && k < n; k++) {
		float uv[2];
		memcpy(uv, gltf->blob + rows.at + (size_t)k * rows.stride, sizeof uv);
		for (int d = 0; d < 2; d++)
			out[2 * k + d] = (float)(t->m[d][0] * (double)uv[0] + t->m[d][1] * (double)uv[1] + t->m[d][2]);
	}
	return out != 0;
}

static bool move_all(struct gltf *gltf, struct err *err)
{
	size_t m, p;
	json_t *mesh, *primitive;
	struct moved *done = 0;
	size_t n = 0;
	bool ok = true;
	json_array_foreach(json_object_get(gltf->root, "meshes"), m, mesh)
		json_array_foreach(json_object_get(mesh, "primitives"), p, primitive) {
			json_t *attributes = json_object_get(primitive, "attributes");
			struct moved one = { gltf_count(attributes, "TEXCOORD_0", -1, INT32_MAX), gltf_count(primitive, "material", -1, INT32_MAX), -1 };
			const struct transform t = transform_of(gltf_item(gltf, "materials", one.material));
			if (!ok || !t.is || one.accessor < 0)
				continue;
			for (size_t i = 0; i < n; i++)
				if (done[i].accessor == one.accessor && done[i].material == one.material)
					one.to = done[i].to;
			if (one.to < 0) {
				ok = move_coordinates(&one.to, gltf, one.accessor, &t, err);
				done = mem_grow(done, n + 1, sizeof *done);
				done[n++] = one;
			}
			json_object_set_new(attributes, "TEXCOORD_0", json_integer(one.to));
		}
	free(done);
	return ok;
}

bool gltf_textures(struct gltf *gltf, struct err *err)
{
	size_t i;
	json_t *item;
	json_array_foreach(json_object_get(gltf->root, "textures"), i, item) {
		json_t *source = json_object_get(other_picture(item), "source");
		// A PNG or JPEG beside it is the same picture.
		if (source && !json_object_get(item, "source"))
			json_object_set(item, "source", source);
	}
	if (!move_all(gltf, err))
		return false;
	json_array_foreach(json_object_get(gltf->root, "materials"), i, item)
		for (int s = 0; s < SLOTS; s++)
			json_object_del(json_object_get(slot(item, s), "extensions"), TRANSFORM);
	return true;
}
