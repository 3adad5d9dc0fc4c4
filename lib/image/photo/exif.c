#include <ctype.h>
#include <libexif/exif-data.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/photo/impl.h"

/* The entry in any of the blocks; null if absent. */
static ExifEntry *entry_of(ExifData *data, ExifTag tag)
{
	for (int ifd = 0; ifd < EXIF_IFD_COUNT; ifd++) {
		ExifEntry *e = ifd == EXIF_IFD_1 ? 0 : exif_content_get_entry(data->ifd[ifd], tag);  // IFD 1: the thumbnail's
		if (e && e->data && e->components && e->size >= e->components * exif_format_get_size(e->format))
			return e;
	}
	return 0;
}

/* Whether the pixels are Adobe RGB's: DCF 2.0 has them marked by the interoperability index R03 beside a colour space that is not sRGB. */
static bool is_adobe_rgb(ExifData *data, double colour_space)
{
	enum { SRGB = 1 };
	ExifEntry *e = exif_content_get_entry(data->ifd[EXIF_IFD_INTEROPERABILITY], EXIF_TAG_INTEROPERABILITY_INDEX);
	return e && e->data && e->size >= 3 && !memcmp(e->data, "R03", 3) && colour_space != SRGB;
}

/* First number of an entry; NAN where absent or not a number. */
static double number_of(ExifData *data, ExifTag tag)
{
	ExifEntry *e = entry_of(data, tag);
	ExifByteOrder order = exif_data_get_byte_order(data);
	if (!e)
		return NAN;
	switch (e->format) {
	case EXIF_FORMAT_SHORT:
		return exif_get_short(e->data, order);
	case EXIF_FORMAT_LONG:
		return exif_get_long(e->data, order);
	case EXIF_FORMAT_RATIONAL: {
		ExifRational r = exif_get_rational(e->data, order);
		return r.denominator ? (double)r.numerator / r.denominator : NAN;
	}
	default:
		return NAN;
	}
}

static void text_of(char *out, size_t size, ExifData *data, ExifTag tag)
{
	ExifEntry *e = entry_of(data, tag);
	size_t n = 0;
	for (; e && n + 1 < size && n < e->size && e->data[n]; n++)
		out[n] = (char)(isprint(e->data[n]) ? e->data[n] : '?');
	while (n && out[n - 1] == ' ')
		n--;
	out[n] = 0;
}

void photo_exif_block(struct photo *photo, struct bytes tiff)
{
	enum { BLOCK_MAX = 1 << 16 };
	if (tiff.n < 8 || tiff.n > BLOCK_MAX)
		return;
	// libexif wants the six bytes that stand before the block in a JPEG.
	unsigned char *block = mem_array(tiff.n + 6, 1);
	memcpy(block, "Exif\0", 6);
	memcpy(block + 6, tiff.p, tiff.n);
	ExifData *data = exif_data_new_from_data(block, (unsigned)tiff.n + 6);
	free(block);
	if (!data)
		return;
	double orientation = number_of(data, EXIF_TAG_ORIENTATION), unit = number_of(data, EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT);
	photo->exif.orientation = orientation >= 1 && orientation <= 8 ? (int)orientation : 1;
	text_of(photo->exif.model, sizeof photo->exif.model, data, EXIF_TAG_MODEL);
	struct photo_lens lens = {
		.focal_mm = number_of(data, EXIF_TAG_FOCAL_LENGTH),
		.focal_35mm = number_of(data, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM),
		.plane_res = number_of(data, EXIF_TAG_FOCAL_PLANE_X_RESOLUTION),
		.plane_unit_mm = unit == 3 ? 10 : unit == 4 ? 1 : 25.4,  // EXIF 2.3: inch is the default
		.full_width = number_of(data, EXIF_TAG_PIXEL_X_DIMENSION),
		.full_height = number_of(data, EXIF_TAG_PIXEL_Y_DIMENSION),
	};
	photo->exif.adobe_rgb = is_adobe_rgb(data, number_of(data, EXIF_TAG_COLOR_SPACE));
	exif_data_unref(data);
	photo_focal(&photo->exif, &lens, photo->width, photo->height);
}

static bool within(double x, double lo, double hi)
{
	return x >= lo && x <= hi;
}

void photo_focal(struct photo_exif *exif, const struct photo_lens *lens, int width, int height)
{
	exif->focal_mm = within(lens->focal_mm, 1, 3000) ? lens->focal_mm : NAN;
	exif->focal_35mm = within(lens->focal_35mm, 5, 10000) ? lens->focal_35mm : NAN;
	exif->focal_px = NAN;
	if (!width || !height)
		return;
	double longer = fmax(width, height), shorter = fmin(width, height);
	double full = fmax(lens->full_width, lens->full_height), full_short = fmin(lens->full_width, lens->full_height);
	bool scaled = full >= 1 && full_short >= 1;
	// The picture has another aspect ratio than the camera gave it: it was cropped, and its focal length in px is unknown.
	if (scaled && fabs(full / full_short - longer / shorter) > 0.02 * longer / shorter)
		return;
	// CIPA DCG-001: the equivalent focal length compares diagonals; that of 36 × 24 mm is 43.27 mm.
	double by_35mm = exif->focal_35mm * hypot(width, height) / 43.2666;
	double per_mm = lens->plane_res / lens->plane_unit_mm * (scaled ? longer / full : 1);
	// Sensors are 3 mm (telephones) to 70 mm (medium format) long; some cameras write values outside of that.
	double by_plane = within(longer / per_mm, 3, 70) ? exif->focal_mm * per_mm : NAN;
	if (isfinite(by_plane) && isfinite(by_35mm) && fabs(by_plane - by_35mm) > 0.1 * by_35mm)
		return;
	exif->focal_px = isfinite(by_plane) ? by_plane : by_35mm;
}
