/* reflectance_full: the iris' reflectance by the full integral over 380 to 780 nm, exact for the order of scattering that the tissue
 * asks for: what bands and effective coefficients are measured against. */
#ifndef TESTS_REFLECTANCE_FULL_H
#define TESTS_REFLECTANCE_FULL_H
#include "tissue/tissue.h"

/* As tissue_reflectance (tissue/tissue.h): linear Rec. 709 under the observer's light; stroma mm; cosines in (0, 1]. */
void tissue_reflectance_full(double rgb[3], const struct tissue *tissue, const struct observer *observer, double stroma,
                             double cos_view, double cos_light);

#endif
