#include "character/plain/plain.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "character/plain/impl.h"

enum { HEAD = 12, CHUNK = 8 };
static const uint32_t JSON_CHUNK = 0x4e4f534a, BIN_CHUNK = 0x004e4942;

static uint32_t le32(const char *p)
{
	const uint8_t *b = (const uint8_t *)p;
	return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void put32(char *p, size_t x)
{
	for (int i = 0; i < 4; i++)
		p[i] = (char)(x >> 8 * i);
}

/* The text and the binary chunk of a .glb, or of a .gltf, which is text alone. */
static bool gltf_open(struct gltf *gltf, const char *file, size_t size)
{
	size_t at = HEAD + CHUNK, length = size;
	const char *text = file;
	if (size >= HEAD + CHUNK && !memcmp(file, "glTF", 4)) {
		length = le32(file + HEAD);
		text = file + at;
		if (le32(file + HEAD + 4) != JSON_CHUNK || length > size - at)
			return false;
		at += length;
		if (size - at >= CHUNK && le32(file + at + 4) == BIN_CHUNK) {
			gltf->bin = file + at + CHUNK;
			gltf->bin_size = le32(file + at);
			if (gltf->bin_size > size - at - CHUNK)
				return false;
		}
	}
	gltf->root = json_loadb(text, length, 0, 0);
	return json_is_object(gltf->root);
}

/* A .glb whose end is missing. Version 2 says its length; version 1 says it in the same place. */
static bool is_cut(const char *file, size_t size)
{
	return size >= HEAD && !memcmp(file, "glTF", 4) && le32(file + 8) > size;
}

static bool is_packed(const struct gltf *gltf)
{
	size_t i;
	json_t *view;
	json_array_foreach(json_object_get(gltf->root, "bufferViews"), i, view)
		if (gltf_packed(view))
			return true;
	return false;
}

/* The extensions that are no longer in it are no longer said to be. */
static void forget_extensions(json_t *root)
{
	static const char *const gone[] = { "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_mesh_quantization", "KHR_texture_transform", "EXT_texture_webp" },
	                  *const lists[] = { "extensionsUsed", "extensionsRequired" };
	for (int l = 0; l < COUNT(lists); l++) {
		json_t *list = json_object_get(root, lists[l]);
		for (size_t i = json_array_size(list); i-- > 0;)
			for (int k = 0; k < COUNT(gone); k++) {
				const char *name = json_string_value(json_array_get(list, i));
				if (name && !strcmp(name, gone[k])) {
					json_array_remove(list, i);
					break;
				}
			}
	}
}

/* The .glb of the text and the new buffer. */
static bool gltf_close(char **out, size_t *size, struct gltf *gltf, struct err *err)
{
	json_object_set_new(gltf->root, "buffers", json_pack("[{sI}]", "byteLength", (json_int_t)gltf->size));
	char *text = json_dumps(gltf->root, JSON_COMPACT);
	if (!text)
		return err_set(err, "its text is no text");
	const size_t length = strlen(text), padded = (length + 3) & ~(size_t)3, bin = (gltf->size + 3) & ~(size_t)3;
	*size = HEAD + 2 * CHUNK + padded + bin;
	char *p = *out = mem_new(*size + 1, 1);
	memcpy(p, "glTF", 4);
	put32(p + 4, 2);
	put32(p + 8, *size);
	put32(p + HEAD, padded);
	put32(p + HEAD + 4, JSON_CHUNK);
	memset(p + HEAD + CHUNK, ' ', padded);
	memcpy(p + HEAD + CHUNK, text, length);
	p += HEAD + CHUNK + padded;
	put32(p, bin);
	put32(p + 4, BIN_CHUNK);
	if (gltf->size)
		memcpy(p + CHUNK, gltf->blob, gltf->size);
	free(text);
	return true;
}

bool gltf_plain(char **out, size_t *out_size, const char *file, size_t size, gltf_load *load, void *ctx, struct err *err)
{
	struct gltf gltf = { 0 };
	*out = 0;
	*out_size = 0;
	const bool opened = gltf_open(&gltf, file, size);
	// What is no glTF is left to the reader, which says so; of one that was copied in part it would say that nobody knows its format.
	bool ok = opened || !is_cut(file, size) || err_set(err, "ends after %zu of its %u bytes", size, le32(file + 8));
	if (opened && (is_packed(&gltf) || gltf_is_quantised(&gltf) || gltf_has_textures(&gltf))) {
		ok = gltf_unpack(&gltf, load, ctx, err) && gltf_floats(&gltf, err) && gltf_textures(&gltf, err);
		json_object_del(gltf.root, "animations");
		forget_extensions(gltf.root);
		ok = ok && gltf_close(out, out_size, &gltf, err);
	}
	gltf_free(&gltf);
	return ok;
}
