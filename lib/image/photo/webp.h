/* webp: WebP photographs, by libwebp.
 */
#ifndef IMAGE_PHOTO_WEBP_H
#define IMAGE_PHOTO_WEBP_H
#include "image/photo/impl.h"

/* Walks the RIFF chunks: size, EXIF; false, err set, where one of them is cut off, or the file is an animation. */
bool photo_parse_webp(struct photo *photo, struct bytes file, struct err *err);

/* rgb[height][width][3] of what photo_parse_webp has accepted, before orientation; and its colour space. */
bool photo_decode_webp(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err);

#endif
