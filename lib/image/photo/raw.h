/* raw: cameras' raw files and DNG, developed by libraw: white balance as the camera set it, sRGB, no automatic brightening, so that
 * photographs of a series keep their exposure. It is loaded when the first of them is met.
 */
#ifndef IMAGE_PHOTO_RAW_H
#define IMAGE_PHOTO_RAW_H
#include "image/photo/impl.h"

/* Size (upright), lens and camera. False, err set, where libraw does not know the camera or the file is cut short. */
bool photo_parse_raw(struct photo *photo, struct bytes file, struct err *err);

/* rgb[height][width][3], 16 bits, upright; sRGB. Highlights are clipped. Draws on one thread; the same bytes every time. */
bool photo_decode_raw(const struct photo *photo, uint16_t *rgb, struct bytes file, struct err *err);

#endif
