#include <math.h>
#include <string.h>

#include "image/photo/impl.h"

enum { JPEG_SCANS_MAX = 200, PNG_CHUNKS_MAX = 100000 };

/* Kinds that are known but not read, each with what to do about it. */
static const struct {
	const char *magic;
	int at, n;
	const char *advice;
} refused[] = {
	{ "ftyphei", 4, 7, "HEIC: save it as JPEG, PNG or 16-bit TIFF" },
	{ "ftypmif1", 4, 8, "HEIF: save it as JPEG, PNG or 16-bit TIFF" },
	{ "ftypavif", 4, 8, "AVIF: save it as JPEG, PNG or 16-bit TIFF" },
	{ "ftypcrx", 4, 7, "a camera's raw file: develop it to 16-bit TIFF" },
	{ "ftyp", 4, 4, "a video: photographs go into photos/, videos into video/" },
	{ "WEBP", 8, 4, "WebP: save it as JPEG, PNG or 16-bit TIFF" },
	{ "GIF8", 0, 4, "GIF: 256 colours are too few, photograph it as JPEG" },
	{ "BM", 0, 2, "BMP: save it as PNG" },
	{ "8BPS", 0, 4, "Photoshop: export it as 16-bit TIFF" },
	{ "%PDF", 0, 4, "PDF, must be a photograph" },
	{ "FUJIFILMCCD-RAW", 0, 15, "a camera's raw file: develop it to 16-bit TIFF" },
	{ "IIU\0", 0, 4, "a camera's raw file: develop it to 16-bit TIFF" },
	{ "IIRO", 0, 4, "a camera's raw file: develop it to 16-bit TIFF" },
	{ "\0\0\0\fjP  ", 0, 8, "JPEG 2000: save it as JPEG, PNG or 16-bit TIFF" },
};

static bool starts(struct bytes file, const char *magic, size_t n)
{
	return file.n >= n && !memcmp(file.p, magic, n);
}

static enum photo_kind kind_of(struct bytes file)
{
	if (starts(file, "\xff\xd8\xff", 3))
		return PHOTO_JPEG;
	if (starts(file, "\x89PNG\r\n\x1a\n", 8))
		return PHOTO_PNG;
	if (starts(file, "II*\0", 4) || starts(file, "MM\0*", 4) || starts(file, "II+\0", 4) || starts(file, "MM\0+", 4))
		return PHOTO_TIFF;
	if (starts(file, "\x76\x2f\x31\x01", 4))
		return PHOTO_EXR;
	return PHOTO_NONE;
}

static bool refuse_kind(struct bytes file, struct err *err)
{
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		if (starts(bytes_from(file, (size_t)refused[i].at), refused[i].magic, (size_t)refused[i].n))
			return err_set(err, "is %s", refused[i].advice);
	return err_set(err, "is no photograph: must be JPEG, PNG, TIFF or EXR");
}

/* SOF0 to SOF15 without DHT, JPG and DAC, which share their numbers. */
static bool is_frame(int marker)
{
	return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

static bool take_frame(struct photo *photo, struct bytes file, size_t at, int marker, struct err *err)
{
	int bits = (int)bytes_be(file, at + 2, 1), components = (int)bytes_be(file, at + 7, 1);
	if (marker != 0xc0 && marker != 0xc1 && marker != 0xc2)
		return err_set(err, "is a JPEG of a kind hardly any program reads (frame type %d): save it again",
		               marker - 0xc0);
	if (components == 4)
		return err_set(err, "is a CMYK picture: convert it to RGB");
	if (components != 1 && components != 3)
		return err_set(err, "JPEG components = %d: must be 1 or 3", components);
	if (bits != 8)
		return err_set(err, "JPEG bits = %d: must be 8", bits);
	photo->height = (int)bytes_be(file, at + 3, 2);
	photo->width = (int)bytes_be(file, at + 5, 2);
	photo->bits = bits;
	photo->grey = components == 1;
	return true;
}

/* Walks all markers to the end of the image: a picture cut short anywhere has none. */
static bool parse_jpeg(struct photo *photo, struct bytes file, struct err *err)
{
	struct bytes exif = { 0 };
	size_t at = 2;
	int scans = 0;
	bool in_scan = false;
	while (at + 1 < file.n) {
		const uint8_t *ff = memchr(file.p + at, 0xff, file.n - at - 1);
		if (!ff)
			break;
		size_t found = (size_t)(ff - file.p);
		int marker = ff[1];
		if (!in_scan && found != at)
			return err_set(err, "is damaged: no JPEG segment at byte %zu", at);
		at = found + (marker == 0xff ? 1 : 2);
		if (marker == 0xff || !marker || (marker >= 0xd0 && marker <= 0xd7) || marker == 0x01)
			continue;
		if (marker == 0xd9) {
			if (!photo->width || !scans)
				return err_set(err, "is a JPEG without a picture in it");
			photo_exif_block(photo, exif);
			return true;
		}
		size_t length = bytes_be(file, at, 2);
		if (length < 2 || length > file.n - at)
			break;
		if (is_frame(marker) && !photo->width && !take_frame(photo, file, at, marker, err))
			return false;
		if (marker == 0xe1 && length > 8 && !memcmp(file.p + at + 2, "Exif\0", 6))
			exif = (struct bytes){ file.p + at + 8, length - 8 };
		in_scan = marker == 0xda;
		if (in_scan && ++scans > JPEG_SCANS_MAX)
			return err_set(err, "has more than %d JPEG scans: made to keep a decoder busy", JPEG_SCANS_MAX);
		at += length;
	}
	return err_set(err, "is truncated: the JPEG has no end; copy it from the camera again");
}

static bool parse_png(struct photo *photo, struct bytes file, struct err *err)
{
	size_t at = 8;
	bool data = false;
	if (bytes_be(file, at + 4, 4) != 0x49484452)
		return err_set(err, "is damaged: the PNG does not begin with its header");
	photo->width = (int)(bytes_be(file, 16, 4) & 0x7fffffff);
	photo->height = (int)(bytes_be(file, 20, 4) & 0x7fffffff);
	int depth = (int)bytes_be(file, 24, 1), type = (int)bytes_be(file, 25, 1);
	photo->bits = depth == 16 ? 16 : 8;
	photo->grey = type == 0 || type == 4;
	for (int i = 0; i < PNG_CHUNKS_MAX && at < file.n && file.n - at >= 12; i++) {
		size_t length = bytes_be(file, at, 4);
		if (length > file.n - at - 12)
			break;
		uint32_t name = bytes_be(file, at + 4, 4);
		data |= name == 0x49444154;
		if (name == 0x65584966)  // eXIf
			photo_exif_block(photo, (struct bytes){ file.p + at + 8, length });
		if (name == 0x49454e44)  // IEND
			return data ? true : err_set(err, "is a PNG without a picture in it");
		at += length + 12;
	}
	return err_set(err, "is truncated: the PNG has no end; copy it again");
}

bool photo_header(struct photo *photo, const void *data, size_t size, double limit_mpx, struct err *err)
{
	struct bytes file = { data, size };
	*photo = (struct photo){ .exif = { .orientation = 1, .focal_px = NAN, .focal_mm = NAN, .focal_35mm = NAN } };
	if (!size)
		return err_set(err, "is empty");
	static bool (*const parse[])(struct photo *, struct bytes, struct err *) = {
		[PHOTO_JPEG] = parse_jpeg,
		[PHOTO_PNG] = parse_png,
		[PHOTO_TIFF] = photo_parse_tiff,
		[PHOTO_EXR] = photo_parse_exr,
	};
	photo->kind = kind_of(file);
	if (photo->kind == PHOTO_NONE)
		return refuse_kind(file, err);
	struct err why = { 0 };
	bool ok = parse[photo->kind](photo, file, &why);
	// The size first: of two faults it is the one that no new copy mends.
	double mpx = 1e-6 * photo->width * photo->height;
	if (mpx > limit_mpx)
		return err_set(err, "%d x %d = %.0f megapixels: must be <= %g (limit.photo_mpx); photograph or save it smaller",
		               photo->width, photo->height, mpx, limit_mpx);
	if (!ok)
		return err_set(err, "%s", why.msg);
	if ( (photo->width < 16 || photo->height < 16))
		return err_set(err, "%d x %d px: must be at least 16 x 16", photo->width, photo->height);
	return true;
}
