#ifndef RENDER_COMPARE_H
#define RENDER_COMPARE_H
#include "render/render.h"

/* CIEDE2000 (Sharma, Wu and Dalal 2005) of two linear Rec. 709 colours under D65; values are clamped to 0..1. */
double colour_difference(const float a[3], const float b[3]);

#endif
