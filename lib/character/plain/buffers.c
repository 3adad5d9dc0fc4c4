#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "character/plain/impl.h"

static int digit(char c)
{
	return c >= 'A' && c <= 'Z' ? c - 'A' : c >= 'a' && c <= 'z' ? c - 'a' + 26 : c >= '0' && c <= '9' ? c - '0' + 52 : c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* The bytes of base64 (RFC 4648, section 4), up to its end or its padding. */
static char *base64_bytes(size_t *size, const char *text)
{
	char *out = mem_new(strlen(text) / 4 * 3 + 4, 1);
	uint32_t bits = 0;
	int have = 0;
	*size = 0;
	for (; digit(*text) >= 0; text++) {
		bits = bits << 6 | (uint32_t)digit(*text);
		have += 6;
		if (have >= 8)
			out[(*size)++] = (char)(bits >> (have -= 8));
	}
	return out;
}

/* A name without the per cent signs of a URI (RFC 3986, section 2.1). */
static char *name_of_uri(const char *uri)
{
	char *name = mem_str(uri), *to = name;
	for (const char *p = uri; *p; p++) {
		unsigned byte;
		if (*p == '%' && p[1] && p[2] && sscanf(p + 1, "%2x", &byte) == 1 && byte) {
			*to++ = (char)byte;
			p += 2;
		} else
			*to++ = *p;
	}
	*to = 0;
	return name;
}

const char *gltf_buffer(size_t *size, struct gltf *gltf, long i, gltf_load *load, void *ctx, struct err *err)
{
	const json_t *list = json_object_get(gltf->root, "buffers");
	if (!gltf->buffer) {
		gltf->n_buffers = (int)json_array_size(list);
		gltf->buffer = mem_new((size_t)gltf->n_buffers + 1, sizeof *gltf->buffer);
	}
	if (i < 0 || i >= gltf->n_buffers) {
		err_set(err, "buffers[%ld] is not there", i);
		return 0;
	}
	const char *uri = json_string_value(json_object_get(json_array_get(list, (size_t)i), "uri"));
	if (!uri && i == 0 && gltf->bin) {
		*size = gltf->bin_size;
		return gltf->bin;
	}
	if (!uri) {
		err_set(err, "buffers[%ld] has no bytes", i);
		return 0;
	}
	if (!gltf->buffer[i].data && !strncmp(uri, "data:", 5)) {
		const char *comma = strchr(uri, ',');
		gltf->buffer[i].data = base64_bytes(&gltf->buffer[i].size, comma ? comma + 1 : "");
	} else if (!gltf->buffer[i].data) {
		char *name = name_of_uri(uri);
		const bool ok = load(ctx, &gltf->buffer[i].data, &gltf->buffer[i].size, name, err);
		free(name);
		if (!ok)
			return 0;
	}
	*size = gltf->buffer[i].size;
	return gltf->buffer[i].data;
}

void gltf_free(struct gltf *gltf)
{
	for (int i = 0; i < gltf->n_buffers; i++)
		free(gltf->buffer[i].data);
	free(gltf->buffer);
	free(gltf->blob);
	json_decref(gltf->root);
}
