/* lens: from the linear picture to what a camera would have written: exposure, white balance, blur, noise, tone, JPEG. */
#ifndef EVIDENCE_LENS_H
#define EVIDENCE_LENS_H
#include "canvas.h"

/* rgb: [height][width][3] of 8 bits, overwritten. white: linear colour of what is white and faces the camera; out: what it is in the
 * picture. photo: exposed with more care, seven in ten with sRGB's own curve; of the others, one in six was taken with fewer pixels and
 * enlarged, as small irises are that are looked at closely. poor: of photographs, how many have been enlarged too, 0..1, and by how much
 * they are compressed. radius: of the iris, px. */
void lens_expose(uint8_t *rgb, struct canvas *canvas, float white[3], float radius, bool photo, float poor, struct rng *rng);

#endif
