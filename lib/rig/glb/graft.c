#include "rig/glb/graft.h"

#include <stdint.h>
#include <string.h>

static void shift(json_t *object, const char *key, size_t by)
{
	json_t *number = json_object_get(object, key);
	if (number)
		json_integer_set(number, json_integer_value(number) + (json_int_t)by);
}

/* All members of an object that are numbers: the attributes of a primitive, the accessors of a morph target. */
static void shift_all(json_t *object, size_t by)
{
	const char *key;
	json_t *number;
	json_object_foreach(object, key, number)
		json_integer_set(number, json_integer_value(number) + (json_int_t)by);
}

/* Every object of a material that has an `index` names a texture, in its extensions, too. */
static void shift_textures(json_t *object, size_t by)
{
	const char *key;
	json_t *member;
	shift(object, "index", by);
	json_object_foreach(object, key, member)
		if (json_is_object(member))
			shift_textures(member, by);
}

static void shift_accessor(json_t *a, size_t views)
{
	json_t *sparse = json_object_get(a, "sparse");
	shift(a, "bufferView", views);
	shift(json_object_get(sparse, "indices"), "bufferView", views);
	shift(json_object_get(sparse, "values"), "bufferView", views);
}

static void shift_mesh(json_t *mesh, size_t accessors, size_t materials)
{
	size_t i, k;
	json_t *primitive, *target;
	json_array_foreach(json_object_get(mesh, "primitives"), i, primitive) {
		shift_all(json_object_get(primitive, "attributes"), accessors);
		shift(primitive, "indices", accessors);
		shift(primitive, "material", materials);
		json_array_foreach(json_object_get(primitive, "targets"), k, target)
			shift_all(target, accessors);
	}
}

static void add_names(json_t *to, json_t *from)
{
	size_t i, k;
	json_t *name, *there;
	json_array_foreach(from, i, name) {
		bool has = false;
		json_array_foreach(to, k, there)
			has = has || json_equal(name, there);
		if (!has)
			json_array_append(to, name);
	}
}

/* The JSON of a binary glTF, and where its buffer lies. */
static json_t *open_glb(const char **bin, size_t *bin_size, const char *bytes, size_t size)
{
	enum { HEAD = 20, CHUNK = 8 };
	uint32_t head[5], chunk[2];
	if (size < HEAD + CHUNK)
		return 0;
	memcpy(head, bytes, sizeof head);
	if (head[0] != GLB_MAGIC || head[2] != size || head[3] > size - HEAD - CHUNK)
		return 0;
	memcpy(chunk, bytes + HEAD + head[3], sizeof chunk);
	if (chunk[0] > size - HEAD - CHUNK - head[3])
		return 0;
	*bin = bytes + HEAD + head[3] + CHUNK;
	*bin_size = chunk[0];
	return json_loadb(bytes + HEAD, head[3], 0, 0);
}

int glb_graft(struct glb_buffer *g, const struct glb_arrays *to, const void *bytes, size_t size, int *first, struct err *err)
{
	const char *bin = 0;
	size_t bin_size = 0, i;
	json_t *root = open_glb(&bin, &bin_size, bytes, size), *it;
	if (!root || json_array_size(json_object_get(root, "buffers")) != 1) {
		json_decref(root);
		err_set(err, "no binary glTF of one buffer");
		return 0;
	}
	const size_t views = json_array_size(g->views), accessors = json_array_size(g->accessors), images = json_array_size(to->images);
	const size_t samplers = json_array_size(to->samplers), textures = json_array_size(to->textures), materials = json_array_size(to->materials);
	const size_t at = glb_add_bytes(g, bin, bin_size);
	json_array_foreach(json_object_get(root, "bufferViews"), i, it) {
		json_object_set_new(it, "byteOffset", json_integer(json_integer_value(json_object_get(it, "byteOffset")) + (json_int_t)at));
		json_array_append(g->views, it);
	}
	json_array_foreach(json_object_get(root, "accessors"), i, it) {
		shift_accessor(it, views);
		json_array_append(g->accessors, it);
	}
	json_array_foreach(json_object_get(root, "images"), i, it) {
		shift(it, "bufferView", views);
		json_array_append(to->images, it);
	}
	json_array_extend(to->samplers, json_object_get(root, "samplers"));
	json_array_foreach(json_object_get(root, "textures"), i, it) {
		shift(it, "sampler", samplers);
		shift(it, "source", images);
		json_array_append(to->textures, it);
	}
	json_array_foreach(json_object_get(root, "materials"), i, it) {
		shift_textures(it, textures);
		json_array_append(to->materials, it);
	}
	*first = (int)json_array_size(to->meshes);
	json_array_foreach(json_object_get(root, "meshes"), i, it) {
		shift_mesh(it, accessors, materials);
		json_array_append(to->meshes, it);
	}
	add_names(to->used, json_object_get(root, "extensionsUsed"));
	json_decref(root);
	const int n = (int)json_array_size(to->meshes) - *first;
	if (!n)
		err_set(err, "a glTF without meshes");
	return n;
}
