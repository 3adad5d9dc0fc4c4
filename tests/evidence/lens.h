/* lens: from the linear picture to what a camera would have written: exposure, white balance, blur, noise, tone, JPEG. */
#ifndef EVIDENCE_LENS_H
#define EVIDENCE_LENS_H
#include "canvas.h"

/* rgb: [height][width][3] of 8 bits, overwritten. white: linear colour of what is white and faces the camera. */
void lens_expose(uint8_t *rgb, struct canvas *canvas, const float white[3], struct rng *rng);

#endif
