/* What the files of image/photo share. */
#ifndef IMAGE_PHOTO_IMPL_H
#define IMAGE_PHOTO_IMPL_H
#include "image/photo/photo.h"
#include "image/photo/profile.h"

/* Bytes of a stranger's file. Reads past the end give 0: every parser then runs into its own checks. */
struct bytes {
	const uint8_t *p;
	size_t n;
};

static inline struct bytes bytes_from(struct bytes b, size_t at)
{
	return at < b.n ? (struct bytes){ b.p + at, b.n - at } : (struct bytes){ b.p, 0 };
}

static inline uint32_t bytes_be(struct bytes b, size_t at, int n)
{
	uint32_t v = 0;
	for (int i = 0; i < n; i++)
		v = v << 8 | (at < b.n && b.n - at > (size_t)i ? b.p[at + (size_t)i] : 0);
	return v;
}

static inline uint32_t bytes_le(struct bytes b, size_t at, int n)
{
	uint32_t v = 0;
	for (int i = n - 1; i >= 0; i--)
		v = v << 8 | (at < b.n && b.n - at > (size_t)i ? b.p[at + (size_t)i] : 0);
	return v;
}

/* Parsers of file headers. Each fills width, height, bits, grey and exif; that of TIFF sets only kind for a camera's raw file.
 * False, err set (the rule broken), when the file should not be decoded. */
bool photo_parse_tiff(struct photo *photo, struct bytes file, struct err *err);
bool photo_parse_exr(struct photo *photo, struct bytes file, struct err *err);

/* What the camera says of its lens, in EXIF's terms; NAN where it does not. */
struct photo_lens {
	double focal_mm, focal_35mm;
	double plane_res, plane_unit_mm;  // pixels a unit on the sensor; length of the unit
	double full_width, full_height;   // pixels of the picture as the camera wrote it
};

/* exif->focal_px for a picture of width × height, where the lens' numbers are believable. */
void photo_focal(struct photo_exif *exif, const struct photo_lens *lens, int width, int height);

/* A block of EXIF data as JPEG and PNG carry it: TIFF header first. */
void photo_exif_block(struct photo *photo, struct bytes tiff);

/* In which colour space a decoder's values are: an ICC profile (owned; null: none), or else code points. */
struct photo_space {
	uint8_t *icc;
	size_t size;
	struct photo_cicp cicp;
};

/* No profile is longer; those of printers, which are refused, reach a few megabytes. */
#define PHOTO_ICC_MOST ((size_t)16 << 20)

/* A copy of the profile's bytes, where there are any, and not too many. */
void photo_space_take(struct photo_space *space, struct bytes icc);

/* The profile that a JPEG carries in its segments APP2; none where a part of it is missing or it has none. */
void photo_space_jpeg(struct photo_space *space, struct bytes file);

/* Turns rgb[h][w] by an EXIF orientation, 2 to 8, without a second copy of it: afterwards [w][h] from 5 on. */
void photo_turn_in_place(uint16_t (*rgb)[3], int orientation, int w, int h);

/* Decoders: encoded values of what photo_header has accepted, rgb[height][width][3] before orientation, and their colour space. */
bool photo_decode_jpeg(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err);
/* Sets width and height to the smallest of those the decoder reduces to that are no shorter than side, either of them. */
void photo_reduce_jpeg(struct photo *photo, int side);
bool photo_decode_png(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err);
bool photo_decode_tiff(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err);

/* out = 257 in: 8-bit values to 16 bits, n of them. */
void photo_widen(uint16_t *out, const uint8_t *in, size_t n);

/* Where 8-bit values are decoded to, in the last n bytes of n numbers of 16 bits; and the same that stand there widened, without a copy. */
uint8_t *photo_narrow(uint16_t *rgb, size_t n);
void photo_widen_in_place(uint16_t *rgb, size_t n);

#endif
