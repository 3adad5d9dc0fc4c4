#include <pthread.h>

#include "base/dynamic.h"
#include "image/video/api.h"

struct video_api av;

static char missing[512];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void load(void)
{
#define OPEN(name, major) dynamic_library(DYNAMIC_SONAME(name, major), missing, sizeof missing)
	void *format = OPEN("avformat", LIBAVFORMAT_VERSION_MAJOR), *codec = OPEN("avcodec", LIBAVCODEC_VERSION_MAJOR);
	void *scale = OPEN("swscale", LIBSWSCALE_VERSION_MAJOR), *util = OPEN("avutil", LIBAVUTIL_VERSION_MAJOR);
#define FROM_FORMAT(name) dynamic_function(&av.name, format, #name, missing, sizeof missing);
#define FROM_CODEC(name) dynamic_function(&av.name, codec, #name, missing, sizeof missing);
#define FROM_SCALE(name) dynamic_function(&av.name, scale, #name, missing, sizeof missing);
#define FROM_UTIL(name) dynamic_function(&av.name, util, #name, missing, sizeof missing);
	VIDEO_API_FORMAT(FROM_FORMAT)
	VIDEO_API_CODEC(FROM_CODEC)
	VIDEO_API_SCALE(FROM_SCALE)
	VIDEO_API_UTIL(FROM_UTIL)
}

bool video_api_load(struct err *err)
{
	pthread_once(&once, load);
	return !*missing || err_set(err, "videos cannot be read or written here: %s (Debian's package: libavformat%d)", missing,
	                            LIBAVFORMAT_VERSION_MAJOR);
}
