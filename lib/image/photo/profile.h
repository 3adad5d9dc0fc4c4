/* profile: colour profiles of photographs. Pixels are brought to sRGB, the space in which all that follows expects them.
 */
#ifndef IMAGE_PHOTO_PROFILE_H
#define IMAGE_PHOTO_PROFILE_H
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

/* Primaries and transfer as ITU-T H.273 numbers them (HEIF and AVIF without an ICC profile): 1 is Rec. 709, 12 Display P3, 9 Rec. 2020;
 * 13 is sRGB's curve. */
struct photo_cicp {
	int primaries, transfer;
};

/* Converts pixels to sRGB through the ICC profile: relative colorimetric, with black point compensation; colours outside of sRGB are
 * clipped.
 * rgb      in, out: [n][3] encoded values, 16 bits
 * profile  ICC bytes; a profile that describes sRGB leaves the pixels as they are, to the bit
 * name     out: the profile's description, printable, at most 63 bytes; "" for sRGB
 * Returns false, err set, where the profile is damaged or not one of RGB pixels (of grey ones for grey pictures). */
bool photo_profile_apply(char name[64], uint16_t *rgb, size_t n, bool grey, const void *profile, size_t size, struct err *err);

/* The same for a colour space that is named by its code points. Unknown ones are taken as sRGB. */
bool photo_cicp_apply(char name[64], uint16_t *rgb, size_t n, const struct photo_cicp *cicp, struct err *err);

/* The same for Adobe RGB (1998), which cameras mark in EXIF alone. */
bool photo_adobe_apply(char name[64], uint16_t *rgb, size_t n, struct err *err);

#endif
