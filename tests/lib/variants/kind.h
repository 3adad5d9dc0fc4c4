/* kind: photographs as telephones, browsers and cameras write them: HEIC, AVIF, WebP, DNG, and colour profiles in all of them. Test tool. */
#ifndef TESTS_KIND_H
#define TESTS_KIND_H
#include <stdbool.h>

#include "tests/lib/variants/variant.h"

/* An RGB space with the white point D65: chromaticities of its primaries, and its curve: sRGB's, or a power. */
struct space {
	double primary[3][2], gamma;  // gamma 0: sRGB's curve
};
extern const struct space space_p3, space_adobe, space_srgb;

/* ICC profile of it, made by lcms2; free(). grey: of one channel with that curve. printer: one of CMYK (a linearisation). */
struct blob icc_of(const struct space *space);
struct blob icc_grey(double gamma);
struct blob icc_printer(void);

/* sRGB value (encoded, 0..1, clipped) of a value in that space: by the matrices of the primaries, without lcms2. */
void space_to_srgb(double srgb[3], const struct space *space, const double rgb[3]);

/* The JPEG or PNG with that profile in it, in as many segments as `parts` (JPEG). */
struct blob with_icc_jpeg(struct blob jpeg, struct blob icc, int parts);
struct blob with_icc_png(struct blob png, struct blob icc);
struct blob with_icc_webp(struct blob webp, struct blob icc, int width, int height);

/* Exact (lossless). */
struct blob encode_webp(const struct pixels *p);

/* Near-lossless HEIC or AVIF of 8 or (HEIC) 10 bits; icc.size 0: none, then the space is named by its code point of primaries (1, 12) where that is
 * not 0. Empty where libheif has no encoder for it. */
struct blob encode_heif(const struct pixels *p, int bits, bool avif, struct blob icc, int primaries);

/* A DNG of a Bayer sensor (RGGB) of that even size, 16 bits, without compression: each 2 x 2 cell holds level[0..3] of 65535; white balance
 * and matrices such that equal levels of a cell are grey. */
struct blob encode_dng(int width, int height, const uint16_t level[4], int orientation);

#endif
