#include "image/photo/raw.h"

#include <libraw/libraw.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/dynamic.h"
#include "base/mem.h"

#define RAW_API(X) \
	X(libraw_close) X(libraw_dcraw_clear_mem) X(libraw_dcraw_make_mem_image) X(libraw_dcraw_process) X(libraw_init) \
	X(libraw_open_buffer) X(libraw_set_dataerror_handler) X(libraw_strerror) X(libraw_unpack)

#define ONE(name) __typeof__(name) *name;
static struct { RAW_API(ONE) } api;
#undef ONE
static char missing[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void load(void)
{
	void *library = dynamic_library(DYNAMIC_SONAME("raw_r", LIBRAW_SHLIB_CURRENT), missing, sizeof missing);
#define LOAD(name) dynamic_function(&api.name, library, #name, missing, sizeof missing);
	RAW_API(LOAD)
#undef LOAD
}

/* libraw 0.21 and later count in 64 bits. */
#if LIBRAW_SHLIB_CURRENT > 20
#define RAW_OFFSET INT64
#else
#define RAW_OFFSET int
#endif

/* What libraw says of damage in the pixels; null where nothing. */
static void on_damage(void *damaged, const char *file, const RAW_OFFSET offset)
{
	(void)file;
	(void)offset;
	*(bool *)damaged = true;
}

static libraw_data_t *open_raw(bool *damaged, struct bytes file, struct err *err)
{
	*damaged = false;
	pthread_once(&once, load);
	if (*missing) {
		err_set(err, "is a camera's raw file, which cannot be read here: %s (Debian's package: libraw20)", missing);
		return 0;
	}
	libraw_data_t *raw = api.libraw_init(0);
	if (!raw) {
		err_set(err, "cannot start the raw decoder");
		return 0;
	}
	api.libraw_set_dataerror_handler(raw, on_damage, damaged);
	libraw_output_params_t *p = &raw->params;
	p->use_camera_wb = 1;
	p->output_color = 1;      // sRGB
	p->output_bps = 16;
	p->gamm[0] = 1 / 2.4;     // sRGB's curve: power, slope of the toe
	p->gamm[1] = 12.92;
	p->no_auto_bright = 1;
	p->user_qual = 3;         // AHD
	p->user_flip = -1;        // upright, as the camera says
	int bad = api.libraw_open_buffer(raw, (void *)(uintptr_t)file.p, file.n);
	if (bad) {
		err_set(err, "is a raw file that cannot be read (%.100s): develop it to 16-bit TIFF", api.libraw_strerror(bad));
		api.libraw_close(raw);
		return 0;
	}
	return raw;
}

bool photo_parse_raw(struct photo *photo, struct bytes file, struct err *err)
{
	bool damaged;
	libraw_data_t *raw = open_raw(&damaged, file, err);
	if (!raw)
		return false;
	bool sideways = raw->sizes.flip & 4;
	photo->width = sideways ? raw->sizes.height : raw->sizes.width;
	photo->height = sideways ? raw->sizes.width : raw->sizes.height;
	photo->bits = 16;
	photo->exif.orientation = 1;
	for (size_t i = 0; i + 1 < sizeof photo->exif.model && raw->idata.model[i]; i++)
		photo->exif.model[i] = (char)(raw->idata.model[i] >= 0x20 && raw->idata.model[i] < 0x7f ? raw->idata.model[i] : '?');
	struct photo_lens lens = {
		.focal_mm = raw->other.focal_len > 0 ? (double)raw->other.focal_len : NAN,
		.focal_35mm = raw->lens.FocalLengthIn35mmFormat > 0 ? raw->lens.FocalLengthIn35mmFormat : NAN,
		.plane_res = NAN, .plane_unit_mm = NAN, .full_width = NAN, .full_height = NAN,
	};
	photo_focal(&photo->exif, &lens, photo->width, photo->height);
	api.libraw_close(raw);
	return true;
}

/* The developed picture into rgb. */
static bool take(uint16_t *rgb, const libraw_processed_image_t *image, const struct photo *photo, struct err *err)
{
	if (!image || image->type != LIBRAW_IMAGE_BITMAP || image->bits != 16 || (image->colors != 3 && image->colors != 1))
		return err_set(err, "is a raw file that was developed to no picture: develop it to 16-bit TIFF");
	if (image->width != photo->width || image->height != photo->height)
		return err_set(err, "has a size that is not the one its header gives");
	size_t n = (size_t)photo->width * (size_t)photo->height;
	for (size_t i = 0; i < 3 * n; i++)
		memcpy(rgb + i, image->data + 2 * (image->colors == 3 ? i : i / 3), 2);
	return true;
}

bool photo_decode_raw(const struct photo *photo, uint16_t *rgb, struct bytes file, struct err *err)
{
	bool damaged;
	libraw_data_t *raw = open_raw(&damaged, file, err);
	if (!raw)
		return false;
	int bad = api.libraw_unpack(raw);
	if (!bad)
		bad = api.libraw_dcraw_process(raw);
	libraw_processed_image_t *image = bad ? 0 : api.libraw_dcraw_make_mem_image(raw, &bad);
	bool ok = bad || damaged ? err_set(err, "is damaged (raw: %.100s): copy it from the camera again", bad ? api.libraw_strerror(bad) : "bytes missing")
	                         : take(rgb, image, photo, err);
	if (image)
		api.libraw_dcraw_clear_mem(image);
	api.libraw_close(raw);
	return ok;
}
