#include "image/photo/webp.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

#include "base/dynamic.h"
#include "base/mem.h"

static struct {
	__typeof__(WebPDecodeRGBInto) *decode;
	__typeof__(WebPGetFeaturesInternal) *features;
} api;
static char missing[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void load(void)
{
	void *library = dynamic_library(DYNAMIC_SONAME("webp", 7), missing, sizeof missing);
	dynamic_function(&api.decode, library, "WebPDecodeRGBInto", missing, sizeof missing);
	dynamic_function(&api.features, library, "WebPGetFeaturesInternal", missing, sizeof missing);
}

/* The chunk of that name; n = 0 where there is none. False where a chunk ends behind the file. */
static bool find_chunk(struct bytes *chunk, struct bytes file, const char name[4])
{
	*chunk = (struct bytes){ file.p, 0 };
	size_t end = (size_t)bytes_le(file, 4, 4) + 8;
	if (end > file.n)
		return false;
	for (size_t at = 12; at + 8 <= end;) {
		size_t length = bytes_le(file, at + 4, 4);
		if (length > end - at - 8)
			return false;
		if (!memcmp(file.p + at, name, 4) && !chunk->n)
			*chunk = (struct bytes){ file.p + at + 8, length };
		at += 8 + length + (length & 1);
	}
	return true;
}

bool photo_parse_webp(struct photo *photo, struct bytes file, struct err *err)
{
	struct bytes exif;
	WebPBitstreamFeatures features;
	pthread_once(&once, load);
	if (*missing)
		return err_set(err, "is WebP, which cannot be read here: %s (Debian's package: libwebp7)", missing);
	if (!find_chunk(&exif, file, "EXIF"))
		return err_set(err, "is truncated: a chunk of the WebP ends behind the file; copy it again");
	if (api.features(file.p, file.n, &features, WEBP_DECODER_ABI_VERSION) != VP8_STATUS_OK)
		return err_set(err, "is damaged: no WebP picture in it");
	if (features.has_animation)
		return err_set(err, "is an animation: photographs go into photos/, videos into video/");
	photo->width = features.width;
	photo->height = features.height;
	photo->bits = 8;
	// Some programs put the six bytes of a JPEG's segment before the block.
	bool jpeg = exif.n > 6 && !memcmp(exif.p, "Exif\0", 6);
	photo_exif_block(photo, jpeg ? bytes_from(exif, 6) : exif);
	return true;
}

bool photo_decode_webp(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err)
{
	size_t n = (size_t)photo->width * (size_t)photo->height * 3;
	bool ok = api.decode(file.p, file.n, photo_narrow(rgb, n), n, 3 * photo->width);
	if (ok)
		photo_widen_in_place(rgb, n);
	struct bytes icc;
	if (ok && find_chunk(&icc, file, "ICCP"))
		photo_space_take(space, icc);
	return ok || err_set(err, "is damaged (WebP): copy it again");
}
