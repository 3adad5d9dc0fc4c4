/* tone: a picture's highlights as film takes them: they bend towards white instead of being cut off at it. */
#ifndef DRAW_TONE_H
#define DRAW_TONE_H
#include "image/image.h"

/* Bends every channel's light, in place: f (2.51 f + 0.03) / (f (2.43 f + 0.59) + 0.14) with f = 0.8 x (Narkowicz's fit of the ACES curve, 2015; 0.8 leaves middle grey about
 * where it was), mixed with what a screen would show of it, cut off at 1.
 * rgb    linear, 1 is white
 * share  0..1 of the curve; 0 leaves the picture as it is, what is brighter than white, too
 * The same as in render/viewer/present.frag. */
void tone(struct image *rgb, double share);

#endif
