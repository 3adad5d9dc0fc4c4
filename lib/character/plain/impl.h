/* Within plain/. */
#ifndef CHARACTER_PLAIN_IMPL_H
#define CHARACTER_PLAIN_IMPL_H
#include <jansson.h>
#include <stdint.h>

#include "character/plain/plain.h"

/* Most bytes of all buffers together. */
static const size_t GLTF_MOST = (size_t)1 << 30;

struct gltf {
	json_t *root;
	const char *bin;            // the file's own binary chunk
	size_t bin_size;
	int n_buffers;
	struct { char *data; size_t size; } *buffer;  // null: no bytes, or the file's own chunk
	uint8_t *blob;              // the new buffer
	size_t size, room;
};

/* gltf.c. root.list[i], an object, or null; its member as a whole number of 0 to most, `otherwise` where it is missing, -1 where it is neither. */
json_t *gltf_item(const struct gltf *gltf, const char *list, long i);
long gltf_count(const json_t *object, const char *key, long otherwise, long most);
/* object.extensions.name; null where there is none. */
json_t *gltf_extension(const json_t *object, const char *name);
/* The same of the two names of meshoptimizer's compression. */
json_t *gltf_packed(const json_t *view);

/* Room for n bytes more at the new buffer's end, at a multiple of 16; where: its offset. Null, err set, beyond GLTF_MOST. */
uint8_t *gltf_more(struct gltf *gltf, size_t n, size_t *where, struct err *err);

/* buffers.c. The bytes of a buffer, size of them; null, err set, when it has none. gltf_free: what was read, and the new buffer. */
const char *gltf_buffer(size_t *size, struct gltf *gltf, long i, gltf_load *load, void *ctx, struct err *err);
void gltf_free(struct gltf *gltf);

/* views.c: every view of the file becomes one of the new buffer, unpacked. */
bool gltf_unpack(struct gltf *gltf, gltf_load *load, void *ctx, struct err *err);

/* accessors.c, after gltf_unpack. Whether any mesh's attribute is of whole numbers that it should not be; makes them floats. */
bool gltf_is_quantised(const struct gltf *gltf);
bool gltf_floats(struct gltf *gltf, struct err *err);
/* Where elements lie in the new buffer: the first, and how far one is from the next. of: an accessor, or one of its sparse lists; element: bytes of one, n: how many.
 * False, err set (by `accessor`'s index), where its view is not there or ends before. */
struct gltf_rows {
	size_t at, stride;
};
bool gltf_rows(struct gltf_rows *rows, const struct gltf *gltf, const json_t *of, size_t element, long n, long accessor, struct err *err);
/* How many numbers each of its elements has; zero where it is not known. */
int gltf_components(const json_t *accessor);
/* An accessor of n elements of c floats of its own: appended to the file; *index. Null, err set. */
float *gltf_new_floats(int *index, struct gltf *gltf, const char *type, long n, int c, struct err *err);

/* textures.c. Whether there are WebP textures, or transformed coordinates; after gltf_floats: textures name their picture, coordinates are transformed. */
bool gltf_has_textures(const struct gltf *gltf);
bool gltf_textures(struct gltf *gltf, struct err *err);

#endif
