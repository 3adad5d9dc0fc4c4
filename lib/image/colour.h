/* colour: CIE L*a*b* and colour differences. */
#ifndef IMAGE_COLOUR_H
#define IMAGE_COLOUR_H

/* CIE L*a*b* under D65 of a linear Rec. 709 colour; values are clamped to 0..1. */
void colour_lab(double lab[3], const float rgb[3]);

/* CIEDE2000 (Sharma, Wu and Dalal 2005) of two L*a*b* colours. About 1 is a difference that is just noticeable. */
double colour_difference_lab(const double a[3], const double b[3]);

/* The same of two linear Rec. 709 colours. */
double colour_difference(const float a[3], const float b[3]);

#endif
