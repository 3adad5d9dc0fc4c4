#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "image/photo/heif.h"
#include "image/photo/impl.h"
#include "image/photo/raw.h"
#include "image/photo/webp.h"

enum { JPEG_SCANS_MAX = 200, PNG_CHUNKS_MAX = 100000 };

/* Kinds that are known but not read, each with what to do about it. */
static const struct {
	const char *magic;
	int at, n;
	const char *advice;
} refused[] = {
	{ "ftyp", 4, 4, "a video: photographs go into photos/, videos into video/" },
	{ "GIF8", 0, 4, "GIF: 256 colours are too few, photograph it as JPEG" },
	{ "BM", 0, 2, "BMP: save it as PNG" },
	{ "8BPS", 0, 4, "Photoshop: export it as 16-bit TIFF" },
	{ "%PDF", 0, 4, "PDF, must be a photograph" },
	{ "\0\0\0\fjP  ", 0, 8, "JPEG 2000: save it as JPEG, PNG or 16-bit TIFF" },
};

static bool starts(struct bytes file, const char *magic, size_t n)
{
	return file.n >= n && !memcmp(file.p, magic, n);
}

/* What tells the kinds apart. The raw kinds that are TIFF files inside are told by their tags (tiff.c), but for Canon's. */
static const struct {
	const char *magic;
	int at, n;
	enum photo_kind kind;
} kinds[] = {
	{ "\xff\xd8\xff", 0, 3, PHOTO_JPEG }, { "\x89PNG\r\n\x1a\n", 0, 8, PHOTO_PNG }, { "CR\2", 8, 3, PHOTO_RAW },
	{ "II*\0", 0, 4, PHOTO_TIFF }, { "MM\0*", 0, 4, PHOTO_TIFF }, { "II+\0", 0, 4, PHOTO_TIFF }, { "MM\0+", 0, 4, PHOTO_TIFF },
	{ "\x76\x2f\x31\x01", 0, 4, PHOTO_EXR }, { "ftyphei", 4, 7, PHOTO_HEIF }, { "ftypmif1", 4, 8, PHOTO_HEIF },
	{ "ftypavif", 4, 8, PHOTO_HEIF }, { "WEBP", 8, 4, PHOTO_WEBP }, { "ftypcrx", 4, 7, PHOTO_RAW },
	{ "FUJIFILMCCD-RAW", 0, 15, PHOTO_RAW }, { "IIU\0", 0, 4, PHOTO_RAW }, { "IIRO", 0, 4, PHOTO_RAW }, { "IIRS", 0, 4, PHOTO_RAW },
	{ "MMOR", 0, 4, PHOTO_RAW },
};

static enum photo_kind kind_of(struct bytes file)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (starts(bytes_from(file, (size_t)kinds[i].at), kinds[i].magic, (size_t)kinds[i].n))
			return kinds[i].kind;
	return PHOTO_NONE;
}

enum photo_kind photo_kind_of(const char *path)
{
	uint8_t head[32];
	// Not to wait for a pipe's other end.
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	ssize_t n = fd >= 0 ? read(fd, head, sizeof head) : -1;
	if (fd >= 0)
		close(fd);
	return n > 0 ? kind_of((struct bytes){ head, (size_t)n }) : PHOTO_NONE;
}

static bool refuse_kind(struct bytes file, struct err *err)
{
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		if (starts(bytes_from(file, (size_t)refused[i].at), refused[i].magic, (size_t)refused[i].n))
			return err_set(err, "is %s", refused[i].advice);
	return err_set(err, "is no photograph: must be JPEG, PNG, TIFF, HEIC, AVIF, WebP, EXR or a camera's raw file");
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

/* Walks all markers to the end of the image, which a truncated picture lacks. */
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
	for (int i = 0; at < file.n && file.n - at >= 12; i++) {
		if (i == PNG_CHUNKS_MAX)
			return err_set(err, "has more than %d PNG chunks: made to keep a decoder busy", PNG_CHUNKS_MAX);
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
		[PHOTO_HEIF] = photo_parse_heif,
		[PHOTO_WEBP] = photo_parse_webp,
		[PHOTO_RAW] = photo_parse_raw,
	};
	photo->kind = kind_of(file);
	if (photo->kind == PHOTO_NONE)
		return refuse_kind(file, err);
	struct err why = { 0 };
	bool ok = parse[photo->kind](photo, file, &why);
	if (ok && photo->kind == PHOTO_RAW && !photo->width)  // a TIFF file that turned out to be one
		ok = photo_parse_raw(photo, file, &why);
	// The size is tested first: of two faults it is the one that a new copy does not mend.
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
