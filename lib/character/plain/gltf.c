#include <string.h>

#include "base/mem.h"
#include "character/plain/impl.h"

json_t *gltf_item(const struct gltf *gltf, const char *list, long i)
{
	json_t *item = json_array_get(json_object_get(gltf->root, list), i < 0 ? SIZE_MAX : (size_t)i);
	return json_is_object(item) ? item : 0;
}

long gltf_count(const json_t *object, const char *key, long otherwise, long most)
{
	const json_t *value = json_object_get(object, key);
	if (!value)
		return otherwise;
	const double x = json_is_number(value) ? json_number_value(value) : -1;
	return x >= 0 && x <= (double)most && x == (double)(long)x ? (long)x : -1;
}

json_t *gltf_extension(const json_t *object, const char *name)
{
	return json_object_get(json_object_get(object, "extensions"), name);
}

json_t *gltf_packed(const json_t *view)
{
	json_t *packed = gltf_extension(view, "EXT_meshopt_compression");
	return packed ? packed : gltf_extension(view, "KHR_meshopt_compression");
}

uint8_t *gltf_more(struct gltf *gltf, size_t n, size_t *where, struct err *err)
{
	const size_t at = (gltf->size + 15) & ~(size_t)15;
	if (n > GLTF_MOST || at > GLTF_MOST - n) {
		err_set(err, "its buffers take more than %zu MiB", GLTF_MOST >> 20);
		return 0;
	}
	if (at + n > gltf->room) {
		gltf->room = at + n + gltf->room;
		gltf->blob = mem_grow(gltf->blob, gltf->room, 1);
	}
	memset(gltf->blob + gltf->size, 0, at + n - gltf->size);
	gltf->size = at + n;
	*where = at;
	return gltf->blob + at;
}
