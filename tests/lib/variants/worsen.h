/* worsen: a video with noise, blur or fewer pixels, or begun later. */
#ifndef TESTS_WORSEN_H
#define TESTS_WORSEN_H
#include <stdint.h>

#include "base/err.h"

/* how: "noise" (Gaussian, 8 of 255 in every channel: a small sensor indoors), "blur" (Gaussian, 2 px: out of focus), "half" (half as many pixels either
 * way), "fifth" (a fifth of them), "as it is", "150" (from its frame 150 on). */
bool worsen_video(const char *out, const char *in, const char *how, struct err *err);

/* A picture's means over `times` pixels either way, in place: its first [height / times][width / times]. */
void worsen_reduce(uint8_t *rgb, int width, int height, int times);

#endif
