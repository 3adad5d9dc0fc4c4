#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "image/video/api.h"

#define TEXT(x) #x
#define SONAME(name, major) "lib" name ".so." TEXT(major)

struct video_api av;

static char missing[512];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void *library(const char *soname)
{
	void *lib = dlopen(soname, RTLD_LAZY | RTLD_LOCAL);
	const char *why = lib ? 0 : dlerror();
	if (!lib && !*missing)
		snprintf(missing, sizeof missing, "%s", why ? why : soname);
	return lib;
}

/* to: a pointer to a function. Copied as bytes, since ISO C does not convert an object's pointer to one; POSIX has them alike. */
static void function(void *to, void *lib, const char *name)
{
	void *f = lib ? dlsym(lib, name) : 0;
	if (!f && !*missing)
		snprintf(missing, sizeof missing, "no function %s", name);
	memcpy(to, &f, sizeof f);
}

static void load(void)
{
	void *format = library(SONAME("avformat", LIBAVFORMAT_VERSION_MAJOR)), *codec = library(SONAME("avcodec", LIBAVCODEC_VERSION_MAJOR));
	void *scale = library(SONAME("swscale", LIBSWSCALE_VERSION_MAJOR)), *util = library(SONAME("avutil", LIBAVUTIL_VERSION_MAJOR));
#define FROM_FORMAT(name) function(&av.name, format, #name);
#define FROM_CODEC(name) function(&av.name, codec, #name);
#define FROM_SCALE(name) function(&av.name, scale, #name);
#define FROM_UTIL(name) function(&av.name, util, #name);
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
