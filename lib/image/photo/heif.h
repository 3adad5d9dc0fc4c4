/* heif: HEIC, HEIF and AVIF photographs, by libheif. It is loaded when the first of them is met.
 */
#ifndef IMAGE_PHOTO_HEIF_H
#define IMAGE_PHOTO_HEIF_H
#include "image/photo/impl.h"

/* Reads the boxes of the file: upright width and height (its own turns and mirrors are applied on decoding), bits, EXIF. False, err
 * set, where it is damaged, holds several pictures (a burst, a film), or libheif is not there. */
bool photo_parse_heif(struct photo *photo, struct bytes file, struct err *err);

/* Decodes the primary picture of what photo_parse_heif has accepted: rgb[height][width][3], 16 bits; and its colour space. */
bool photo_decode_heif(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err);

#endif
