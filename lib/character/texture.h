/* texture: the textures of a look: PNG and JPEG, as glTF knows them. */
#ifndef CHARACTER_TEXTURE_H
#define CHARACTER_TEXTURE_H
#include "character/look.h"

enum { LOOK_TEXTURE_PX = 16384, LOOK_TEXTURE_AREA = 1 << 26 };  // a side, in all

/* Fills width, height and png from the head of the bytes. Returns false, err set, for another kind, a damaged head, or a side longer
 * than LOOK_TEXTURE_PX, or more than LOOK_TEXTURE_AREA px. */
bool look_texture_check(struct look_texture *texture, struct err *err);

/* Decodes a texture, at most `longest` px a side (halved until it is): [height][width][4], 8 bits of sRGB and alpha. free().
 * Returns null, err set, when it is damaged. */
uint8_t *look_texture_pixels(int *width, int *height, const struct look_texture *texture, int longest, struct err *err);

#endif
