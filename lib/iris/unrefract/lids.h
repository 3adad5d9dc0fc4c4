/* lids: the part of the iris that eyelids cover. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_LIDS_H
#define IRIS_UNREFRACT_LIDS_H
#include "iris/unrefract/rings.h"

/* Finds the lids' edge as the best closed path round the sheet (dynamic programming) between iris and what is unlike its ring
 * in brightness or hue, or told to be none; then goes on into the shadow that a lid casts.
 * lid_t   out: for each angle, the t beyond which a lid covers the iris; 1: open
 * logs    logarithms of red, green, blue, [size][size] each
 * seen    [size][size] 0..1: what of the planes is seen
 * iris    [size][size] 0..1: the same, times how likely it is iris: of it the rings' own level is taken
 * cover   [size][size] probability that a lid or lashes cover it, or null */
void unrefract_lids(double lid_t[SHEET_ANGLES], const float *const logs[3], const float *seen, const float *iris,
                    const float *cover, const struct sheet *sheet, const struct unrefract_conf *conf);

#endif
