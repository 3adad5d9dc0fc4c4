/* picture: a picture for a page. */
#ifndef DRAW_WEB_PICTURE_H
#define DRAW_WEB_PICTURE_H
#include <stdint.h>

#include <jansson.h>

/* {uri, width, height} of 8-bit sRGB px[height][width][3] as JPEG in a data: URI. json_decref; null where it cannot be encoded. */
json_t *web_picture(const uint8_t *px, int width, int height);

#endif
