#include "character/webp.h"

#include <png.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

#include "base/dynamic.h"
#include "base/mem.h"

static struct {
	__typeof__(WebPDecodeRGBAInto) *rgba;
	__typeof__(WebPDecodeRGBInto) *rgb;
	__typeof__(WebPGetFeaturesInternal) *features;
} api;
static char missing[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void load(void)
{
	void *library = dynamic_library(DYNAMIC_SONAME("webp", 7), missing, sizeof missing);
	dynamic_function(&api.rgba, library, "WebPDecodeRGBAInto", missing, sizeof missing);
	dynamic_function(&api.rgb, library, "WebPDecodeRGBInto", missing, sizeof missing);
	dynamic_function(&api.features, library, "WebPGetFeaturesInternal", missing, sizeof missing);
}

void look_webp_ready(void)
{
	pthread_once(&once, load);
}

bool look_is_webp(const uint8_t *bytes, size_t size)
{
	return size >= 12 && !memcmp(bytes, "RIFF", 4) && !memcmp(bytes + 8, "WEBP", 4);
}

/* Level 1 of deflate: textures are large, and what leaves is compared by its pixels. */
static uint8_t *png_of(size_t *n, const uint8_t *px, int width, int height, int channels, struct err *err)
{
	png_image image = { .version = PNG_IMAGE_VERSION, .width = (png_uint_32)width, .height = (png_uint_32)height,
		                .format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB, .flags = PNG_IMAGE_FLAG_FAST };
	png_alloc_size_t room = PNG_IMAGE_PNG_SIZE_MAX(image);
	uint8_t *out = mem_array(room, 1);
	if (png_image_write_to_memory(&image, out, &room, 0, px, 0, 0)) {
		*n = room;
		return out;
	}
	err_set(err, "cannot be kept as PNG: %s", image.message);
	free(out);
	return 0;
}

uint8_t *look_webp_png(size_t *n, const uint8_t *bytes, size_t size, int most, struct err *err)
{
	WebPBitstreamFeatures f;
	look_webp_ready();
	if (*missing) {
		err_set(err, "is WebP, which cannot be read here: %s (Debian's package: libwebp7)", missing);
		return 0;
	}
	if (api.features(bytes, size, &f, WEBP_DECODER_ABI_VERSION) != VP8_STATUS_OK || f.has_animation || f.width < 1 || f.height < 1) {
		err_set(err, "is a damaged or moving WebP");
		return 0;
	}
	if (f.width > most || f.height > most) {
		err_set(err, "has %d x %d px, must be at most %d a side", f.width, f.height, most);
		return 0;
	}
	const int channels = f.has_alpha ? 4 : 3;
	const size_t room = (size_t)f.width * (size_t)f.height * (size_t)channels;
	uint8_t *px = mem_array(room, 1), *png = 0;
	if ((channels == 4 ? api.rgba : api.rgb)(bytes, size, px, room, channels * f.width))
		png = png_of(n, px, f.width, f.height, channels, err);
	else
		err_set(err, "is a damaged WebP");
	free(px);
	return png;
}
