/* photo: a photograph as decoded, and what its EXIF says of the camera.
 * The checks before decoding are in header.c: nothing of a stranger's file reaches a decoder before its
 * kind, size and end have been looked at.
 */
#ifndef IMAGE_PHOTO_PHOTO_H
#define IMAGE_PHOTO_PHOTO_H
#include <stddef.h>
#include <stdint.h>

#include "image/image.h"

enum photo_kind { PHOTO_NONE, PHOTO_JPEG, PHOTO_PNG, PHOTO_TIFF, PHOTO_EXR, PHOTO_HEIF, PHOTO_WEBP, PHOTO_RAW };

struct photo_exif {
	int orientation;    // 1..8; 1 where not given
	double focal_px;    // in pixels of this picture; NAN where it does not follow. Focused at infinity: at
	                    // magnification m (close-ups) the image lies (1 + m) times as far behind the lens
	double focal_mm, focal_35mm;  // NAN where not given
	char model[64];     // printable; "" where not given
	bool adobe_rgb;     // the pixels are Adobe RGB's, unless a profile says otherwise
};

struct photo {
	int width, height;  // after the EXIF orientation has been applied
	int bits;           // 8 or 16 of the file
	bool grey;          // without colour: one channel in the file, or (photo_load) three that are alike
	enum photo_kind kind;
	struct photo_exif exif;
	char profile[64];   // name of the colour space that the pixels were converted from; "": sRGB, or none was stated
	uint16_t *rgb;      // [height][width][3]; encoded values (sRGB), 8-bit ones times 257; owned
};

/* The kind of a file by its first bytes; PHOTO_NONE where it cannot be read or is none. */
enum photo_kind photo_kind_of(const char *path);

/* Looks at the head and the tail of a file in memory: kind from its bytes (never from its name), dimensions,
 * channels, bits, whether it is whole. False, err set (rule broken), when it should not be decoded:
 * not a photograph, CMYK, truncated, over limit_mpx megapixels, empty. Fills width, height (before orientation),
 * bits, grey, kind and exif. */
bool photo_header(struct photo *photo, const void *data, size_t size, double limit_mpx, struct err *err);

/* Reads, checks (photo_header) and decodes; EXIF orientation applied: width and height are the upright picture's.
 * False, err set ("path: rule broken"), when it cannot be used. Nothing is printed. photo_free. */
bool photo_load(struct photo *photo, const char *path, double limit_mpx, struct err *err);

/* The same for what is only looked at: where the decoder can halve a JPEG once, twice or three times on its way, for a fraction of the memory
 * and the time, as often as leaves neither side shorter than side px. 0: never. */
bool photo_load_small(struct photo *photo, const char *path, int side, double limit_mpx, struct err *err);

/* Part of the photograph as linear colour; x0, y0 px, clipped by the caller. Three channels. image_free. */
struct image photo_linear(const struct photo *photo, int x0, int y0, int width, int height);

/* The same made smaller: each pixel of out_width x out_height, both at most those of the part, is the mean linear colour of the area
 * that it covers. What photo_linear would hold, 12 bytes a pixel, is never there. image_free. */
struct image photo_shrunk(const struct photo *photo, int x0, int y0, int width, int height, int out_width, int out_height);

/* A picture of bytes [height][3 width] as a photograph in sRGB. photo_free. */
struct photo photo_of_bytes(const uint8_t *rgb, int width, int height);

void photo_free(struct photo *photo);

#endif
