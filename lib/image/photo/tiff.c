#include <math.h>
#include <string.h>

#include "image/photo/impl.h"

enum {
	TAG_SUBFILE = 254, TAG_WIDTH = 256, TAG_HEIGHT, TAG_BITS, TAG_PHOTOMETRIC = 262, TAG_MODEL = 272,
	TAG_STRIPS = 273, TAG_ORIENTATION, TAG_SAMPLES = 277, TAG_STRIP_BYTES = 279, TAG_TILES = 324,
	TAG_TILE_BYTES, TAG_SAMPLE_FORMAT = 339, TAG_EXIF = 34665, TAG_CFA = 33421, TAG_DNG = 50706,
	TAG_FOCAL = 37386, TAG_FULL_WIDTH = 40962, TAG_FULL_HEIGHT, TAG_PLANE_RES = 41486, TAG_PLANE_UNIT = 41488,
	TAG_FOCAL_35MM = 41989,
};

/* TIFF 6.0: a folder of 12-byte entries {tag, type, count, value or offset}. */
struct ifd {
	struct bytes file;
	bool big;     // big-endian
	size_t at;    // of the first entry
	int n;
};

struct entry {
	int type;
	uint32_t count;
	size_t at;  // of the first value
};

static uint32_t get(const struct ifd *d, size_t at, int n)
{
	return d->big ? bytes_be(d->file, at, n) : bytes_le(d->file, at, n);
}

static int type_size(int type)
{
	static const int size[] = { 0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8 };
	return type > 0 && type < 13 ? size[type] : 0;
}

static bool open_ifd(struct ifd *d, size_t at)
{
	if (at < 8 || at > d->file.n || d->file.n - at < 2)
		return false;
	d->n = (int)get(d, at, 2);
	d->at = at + 2;
	return d->n > 0 && (size_t)d->n * 12 <= d->file.n - d->at;
}

/* False where the entry is absent or points out of the file. */
static bool find(const struct ifd *d, int tag, struct entry *e)
{
	for (int i = 0; i < d->n; i++) {
		size_t at = d->at + 12 * (size_t)i;
		if ((int)get(d, at, 2) != tag)
			continue;
		*e = (struct entry){ .type = (int)get(d, at + 2, 2), .count = get(d, at + 4, 4) };
		size_t size = (size_t)type_size(e->type) * e->count;
		e->at = size <= 4 ? at + 8 : get(d, at + 8, 4);
		return size && e->at <= d->file.n && size <= d->file.n - e->at;
	}
	return false;
}

static double value_at(const struct ifd *d, const struct entry *e, uint32_t i)
{
	size_t at = e->at + (size_t)type_size(e->type) * i;
	switch (e->type) {
	case 1:
		return get(d, at, 1);
	case 3:
		return get(d, at, 2);
	case 4:
		return get(d, at, 4);
	case 5: {
		uint32_t below = get(d, at + 4, 4);
		return below ? (double)get(d, at, 4) / below : NAN;
	}
	default:
		return NAN;
	}
}

static double number(const struct ifd *d, int tag, double absent)
{
	struct entry e;
	double v = find(d, tag, &e) ? value_at(d, &e, 0) : NAN;
	return isfinite(v) ? v : absent;
}

/* Every strip or tile has to lie in the file. */
static bool is_whole(const struct ifd *d)
{
	struct entry offset, length;
	bool strips = find(d, TAG_STRIPS, &offset) && find(d, TAG_STRIP_BYTES, &length);
	if (!strips && !(find(d, TAG_TILES, &offset) && find(d, TAG_TILE_BYTES, &length)))
		return false;
	if (offset.count != length.count)
		return false;
	for (uint32_t i = 0; i < offset.count; i++) {
		double end = value_at(d, &offset, i) + value_at(d, &length, i);
		if (!(end <= (double)d->file.n))
			return false;
	}
	return true;
}

/* A camera's raw file: the first picture is a thumbnail, or one of a colour filter array, or the file is a DNG. */
static bool is_raw(const struct ifd *d)
{
	struct entry e;
	return (int)number(d, TAG_SUBFILE, 0) & 1 || (int)number(d, TAG_PHOTOMETRIC, -1) == 32803 || find(d, TAG_DNG, &e)
	       || find(d, TAG_CFA, &e);
}

static bool check_pixels(struct photo *photo, const struct ifd *d, struct err *err)
{
	int photometric = (int)number(d, TAG_PHOTOMETRIC, -1), samples = (int)number(d, TAG_SAMPLES, 1);
	if (photometric == 5)
		return err_set(err, "is a CMYK picture: convert it to RGB");
	if (photometric < 0 || (photometric > 3 && photometric != 6))
		return err_set(err, "TIFF colour space %d: must be RGB or grey", photometric);
	photo->bits = (int)number(d, TAG_BITS, 1);
	if (number(d, TAG_SAMPLE_FORMAT, 1) != 1)
		return err_set(err, "is a TIFF of floating-point or signed values: save it as EXR or 16-bit TIFF");
	if (photo->bits != 8 && !(photo->bits == 16 && photometric <= 2))
		return err_set(err, "TIFF bits = %d: must be 8 or 16", photo->bits);
	if (samples < 1 || samples > 8 || (photometric == 2 && samples < 3))
		return err_set(err, "TIFF channels = %d: must be 1 to 8, RGB at least 3", samples);
	photo->grey = photometric < 2;
	return true;
}

static void read_exif(struct photo *photo, struct ifd *d)
{
	struct entry e;
	double o = number(d, TAG_ORIENTATION, 1);
	photo->exif.orientation = o >= 1 && o <= 8 ? (int)o : 1;
	if (find(d, TAG_MODEL, &e) && e.type == 2)
		for (uint32_t i = 0; i + 1 < e.count && i + 1 < sizeof photo->exif.model; i++) {
			int c = d->file.p[e.at + i];
			photo->exif.model[i] = (char)(c >= 0x20 && c < 0x7f ? c : c ? '?' : 0);
		}
	if (!open_ifd(d, (size_t)number(d, TAG_EXIF, 0)))
		return;
	double unit = number(d, TAG_PLANE_UNIT, 2);
	struct photo_lens lens = {
		.focal_mm = number(d, TAG_FOCAL, NAN),
		.focal_35mm = number(d, TAG_FOCAL_35MM, NAN),
		.plane_res = number(d, TAG_PLANE_RES, NAN),
		.plane_unit_mm = unit == 3 ? 10 : unit == 4 ? 1 : 25.4,
		.full_width = number(d, TAG_FULL_WIDTH, NAN),
		.full_height = number(d, TAG_FULL_HEIGHT, NAN),
	};
	photo_focal(&photo->exif, &lens, photo->width, photo->height);
}

bool photo_parse_tiff(struct photo *photo, struct bytes file, struct err *err)
{
	struct ifd d = { .file = file, .big = file.p[0] == 'M' };
	if (get(&d, 2, 2) == 43)
		return err_set(err, "is a BigTIFF: save it as a plain TIFF");
	if (bytes_be(file, 8, 2) == 0x4352)
		return err_set(err, "is a camera's raw file: develop it to 16-bit TIFF");
	if (!open_ifd(&d, get(&d, 4, 4)))
		return err_set(err, "is truncated: the TIFF's index lies behind its end; copy it again");
	if (is_raw(&d)) {
		photo->kind = PHOTO_RAW;
		return true;
	}
	double width = number(&d, TAG_WIDTH, 0), height = number(&d, TAG_HEIGHT, 0);
	if (width > 1 << 30 || height > 1 << 30)
		return err_set(err, "%.0f x %.0f px: no photograph is that large", width, height);
	photo->width = (int)width;
	photo->height = (int)height;
	if (!check_pixels(photo, &d, err))
		return false;
	if (!is_whole(&d))
		return err_set(err, "is truncated: the TIFF's pixels lie behind its end; copy it again");
	read_exif(photo, &d);
	return true;
}
