/* webp: WebP textures become PNG, which every program knows, by libwebp. */
#ifndef CHARACTER_WEBP_H
#define CHARACTER_WEBP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

/* Loads the library; to be called before a process gives up opening files (base/apart.h). That it is missing is said by look_webp_png. */
void look_webp_ready(void);

bool look_is_webp(const uint8_t *bytes, size_t size);

/* The same picture as PNG: *n bytes, 8 bits of sRGB, and alpha where the picture has it; free(). Null, err set, when it is damaged, moves, or has more than
 * `most` px a side. */
uint8_t *look_webp_png(size_t *n, const uint8_t *bytes, size_t size, int most, struct err *err);

#endif
