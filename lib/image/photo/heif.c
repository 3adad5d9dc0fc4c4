#include "image/photo/heif.h"

#include <libheif/heif.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/dynamic.h"
#include "base/mem.h"

#define HEIF_API(X) \
	X(heif_context_alloc) X(heif_context_free) X(heif_context_get_number_of_top_level_images) X(heif_context_get_primary_image_handle) \
	X(heif_context_read_from_memory_without_copy) X(heif_context_set_maximum_image_size_limit) X(heif_decode_image) \
	X(heif_image_get_bits_per_pixel_range) X(heif_image_get_height) X(heif_image_get_plane_readonly) X(heif_image_get_width) \
	X(heif_image_handle_get_color_profile_type) X(heif_image_handle_get_height) X(heif_image_handle_get_list_of_metadata_block_IDs) \
	X(heif_image_handle_get_luma_bits_per_pixel) X(heif_image_handle_get_metadata) X(heif_image_handle_get_metadata_size) \
	X(heif_image_handle_get_nclx_color_profile) X(heif_image_handle_get_raw_color_profile) \
	X(heif_image_handle_get_raw_color_profile_size) X(heif_image_handle_get_width) X(heif_image_handle_release) X(heif_image_release) \
	X(heif_nclx_color_profile_free)

#define ONE(name) __typeof__(name) *name;
static struct { HEIF_API(ONE) } api;
#undef ONE
static char missing[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void load(void)
{
	void *library = dynamic_library(DYNAMIC_SONAME("heif", 1), missing, sizeof missing);
#define LOAD(name) dynamic_function(&api.name, library, #name, missing, sizeof missing);
	HEIF_API(LOAD)
#undef LOAD
}

struct opened {
	struct heif_context *context;
	struct heif_image_handle *handle;
};

static void close_file(struct opened *o)
{
	if (o->handle)
		api.heif_image_handle_release(o->handle);
	if (o->context)
		api.heif_context_free(o->context);
}

/* libheif's words, short. Always false. */
static bool refused(struct heif_error e, struct err *err)
{
	return err_set(err, "is damaged (%.160s): copy it from the camera again", e.message ? e.message : "HEIF");
}

static bool open_file(struct opened *o, struct bytes file, struct err *err)
{
	*o = (struct opened){ 0 };
	pthread_once(&once, load);
	if (*missing)
		return err_set(err, "is HEIC or AVIF, which cannot be read here: %s (Debian's package: libheif1)", missing);
	o->context = api.heif_context_alloc();
	struct heif_error e = api.heif_context_read_from_memory_without_copy(o->context, file.p, file.n, 0);
	if (e.code != heif_error_Ok)
		return refused(e, err);
	e = api.heif_context_get_primary_image_handle(o->context, &o->handle);
	return e.code == heif_error_Ok || refused(e, err);
}

static void read_exif(struct photo *photo, const struct heif_image_handle *handle)
{
	heif_item_id id;
	if (api.heif_image_handle_get_list_of_metadata_block_IDs(handle, "Exif", &id, 1) != 1)
		return;
	size_t size = api.heif_image_handle_get_metadata_size(handle, id);
	if (size < 4 || size > (1 << 20))
		return;
	uint8_t *block = mem_array(size, 1);
	if (api.heif_image_handle_get_metadata(handle, id, block).code == heif_error_Ok) {
		// The block begins with the distance from behind these four bytes to the TIFF header.
		struct bytes b = { block, size };
		size_t at = 4 + (size_t)bytes_be(b, 0, 4);
		photo_exif_block(photo, bytes_from(b, at));
	}
	free(block);
}

bool photo_parse_heif(struct photo *photo, struct bytes file, struct err *err)
{
	struct opened o;
	bool ok = open_file(&o, file, err);
	if (ok) {
		photo->width = api.heif_image_handle_get_width(o.handle);
		photo->height = api.heif_image_handle_get_height(o.handle);
		photo->bits = api.heif_image_handle_get_luma_bits_per_pixel(o.handle) > 8 ? 16 : 8;
		read_exif(photo, o.handle);
		// The file's own turns are applied by the decoder, and those of EXIF repeat them.
		photo->exif.orientation = 1;
		if (api.heif_context_get_number_of_top_level_images(o.context) > 1)
			ok = err_set(err, "holds several pictures: save the one that is meant as JPEG or TIFF");
	}
	close_file(&o);
	return ok;
}

static void take_space(struct photo_space *space, const struct heif_image_handle *handle)
{
	switch (api.heif_image_handle_get_color_profile_type(handle)) {
	case heif_color_profile_type_rICC:
	case heif_color_profile_type_prof: {
		size_t size = api.heif_image_handle_get_raw_color_profile_size(handle);
		if (!size || size > PHOTO_ICC_MOST)
			return;
		space->icc = mem_array(size, 1);
		space->size = api.heif_image_handle_get_raw_color_profile(handle, space->icc).code == heif_error_Ok ? size : 0;
		return;
	}
	case heif_color_profile_type_nclx: {
		struct heif_color_profile_nclx *nclx = 0;
		if (api.heif_image_handle_get_nclx_color_profile(handle, &nclx).code == heif_error_Ok && nclx) {
			space->cicp = (struct photo_cicp){ (int)nclx->color_primaries, (int)nclx->transfer_characteristics };
			api.heif_nclx_color_profile_free(nclx);
		}
		return;
	}
	default:
		return;
	}
}

static void copy(uint16_t *rgb, const struct heif_image *image, int width, int height, int bits)
{
	int stride = 0;
	const uint8_t *px = api.heif_image_get_plane_readonly(image, heif_channel_interleaved, &stride);
	for (int y = 0; y < height; y++) {
		const uint8_t *line = px + (long)y * stride;
		uint16_t *to = rgb + 3 * (long)y * width;
		if (bits <= 8) {
			photo_widen(to, line, 3 * (size_t)width);
			continue;
		}
		unsigned most = (1u << bits) - 1;
		for (int i = 0; i < 3 * width; i++) {
			unsigned v = line[2 * i] | (unsigned)line[2 * i + 1] << 8;
			to[i] = (uint16_t)((v < most ? v : most) * 65535u / most);
		}
	}
}

bool photo_decode_heif(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err)
{
	struct opened o;
	struct heif_image *image = 0;
	bool ok = open_file(&o, file, err);
	if (ok) {
		struct heif_error e = api.heif_decode_image(o.handle, &image, heif_colorspace_RGB,
		                                            photo->bits > 8 ? heif_chroma_interleaved_RRGGBB_LE : heif_chroma_interleaved_RGB, 0);
		ok = e.code == heif_error_Ok || refused(e, err);
	}
	if (ok && (api.heif_image_get_width(image, heif_channel_interleaved) != photo->width
	           || api.heif_image_get_height(image, heif_channel_interleaved) != photo->height))
		ok = err_set(err, "has a size that is not the one its header gives");
	if (ok) {
		copy(rgb, image, photo->width, photo->height, api.heif_image_get_bits_per_pixel_range(image, heif_channel_interleaved));
		take_space(space, o.handle);
	}
	if (image)
		api.heif_image_release(image);
	close_file(&o);
	return ok;
}
