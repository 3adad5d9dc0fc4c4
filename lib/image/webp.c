#include "image/webp.h"

#include <pthread.h>
#include <webp/decode.h>

#include "base/dynamic.h"

static struct {
	__typeof__(WebPDecodeRGBInto) *rgb, *rgba;
	__typeof__(WebPGetFeaturesInternal) *features;
} api;
static char missing[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void load(void)
{
	void *library = dynamic_library(DYNAMIC_SONAME("webp", 7), missing, sizeof missing);
	dynamic_function(&api.rgb, library, "WebPDecodeRGBInto", missing, sizeof missing);
	dynamic_function(&api.rgba, library, "WebPDecodeRGBAInto", missing, sizeof missing);
	dynamic_function(&api.features, library, "WebPGetFeaturesInternal", missing, sizeof missing);
}

const char *webp_missing(void)
{
	pthread_once(&once, load);
	return *missing ? missing : 0;
}

bool webp_head(struct webp_head *head, const void *bytes, size_t size)
{
	WebPBitstreamFeatures f;
	if (api.features(bytes, size, &f, WEBP_DECODER_ABI_VERSION) != VP8_STATUS_OK)
		return false;
	*head = (struct webp_head){ f.width, f.height, f.has_alpha, f.has_animation };
	return true;
}

bool webp_decode(uint8_t *px, int channels, const struct webp_head *head, const void *bytes, size_t size)
{
	const size_t room = (size_t)head->width * (size_t)head->height * (size_t)channels;
	return (channels == 4 ? api.rgba : api.rgb)(bytes, size, px, room, channels * head->width) != 0;
}
