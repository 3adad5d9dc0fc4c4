/* convert: textures of kinds that glTF does not know become PNG, which every program knows: WebP by libwebp, TIFF by libtiff, TGA and BMP by stb. They read
 * strangers' bytes: in a process of its own (base/apart.h). */
#ifndef CHARACTER_CONVERT_H
#define CHARACTER_CONVERT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

/* Loads what is loaded when it is needed; to be called before a process gives up opening files. That something is missing is said by look_convert. */
void look_convert_ready(void);

/* Whether a picture is of such a kind, by its first bytes; TGA, which has none of its own, by its name. */
bool look_is_foreign(const char *name, const uint8_t *bytes, size_t size);

/* The same picture as PNG: *n bytes, 8 bits of sRGB, and alpha where the picture has it; free(). Null, err set, when it is damaged, moves, or has more than
 * `most` px a side. */
uint8_t *look_convert(size_t *n, const uint8_t *bytes, size_t size, int most, struct err *err);

#endif
