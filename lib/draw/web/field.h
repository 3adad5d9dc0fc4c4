/* field: smooth fields of numbers as few bytes. Values are rounded to whole steps; of each, the difference from what its
 * neighbours foretell (left + above - the corner between them) is stored, modulo 2^32, as a zigzag LEB128 number of 1 to 5 bytes.
 * Graphics.field() (render/viewer/gl.js) decodes it.
 */
#ifndef DRAW_WEB_FIELD_H
#define DRAW_WEB_FIELD_H
#include <stddef.h>
#include <stdint.h>

/* Encodes px[height][width][channels], mm.
 * size  out: bytes
 * step  out: mm; 2^-16 (below the resolution of a float beyond 128 mm) where no value is above 16 m, else as fine as 31 bits
 *       hold the largest
 * Returns the bytes; free(). The decoded value is within half a step; what is not finite becomes 0. */
uint8_t *field_encode(size_t *size, double *step, const float *px, int width, int height, int channels);

#endif
