/* shade: how much light lids and lashes take from the iris beside them. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_SHADE_H
#define IRIS_UNREFRACT_SHADE_H
#include "iris/unrefract/rings.h"

/* Lids stand before the eye: light from above reaches the iris below one the less the nearer to its edge, and the cornea mirrors lashes there in place of
 * the sky. Each lid's share is (1 - d / D)^2 of an amplitude that may differ from one end of the lid to the other, d the distance to its edge in the plane of the
 * iris; D and the amplitude are those by which the iris is most alike all round its rings, robustly. Nothing is taken for shade that does not explain
 * more than what an iris' own pattern may.
 * Divides the survey's colours by it, and lowers the weight of what little light is left of.
 * logs    logarithms of red, green, blue, [size][size] each
 * t       [size][size] the sheet's coordinate
 * lid_t   for each angle, the t beyond which a lid covers the iris
 * iris    [size][size] 1 where it is iris, neither covered nor mirrored over */
void unrefract_shade(struct unrefract_survey *survey, const float *const logs[3], const float *t, const double lid_t[SHEET_ANGLES], const float *iris,
                     const struct sheet *sheet, const struct unrefract_conf *conf);

/* Multiplies a colour by what its light lacks; p: the photograph's own frame, mm. */
void unrefract_unshade(float rgb[3], const struct unrefract_survey *survey, const double p[2]);

#endif
