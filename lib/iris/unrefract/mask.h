/* mask: the weights of a survey: lids, lashes, reflections, pupil and what is hidden get none. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_MASK_H
#define IRIS_UNREFRACT_MASK_H
#include "iris/unrefract/rings.h"
#include "iris/unrefract/told.h"

/* Fills survey's weight, lid_share and glint_share from its rgb.
 * seen  [size][size] 1 where the photograph shows the texel
 * told  of the evidence
 * white  linear colour of white in the photograph */
void unrefract_mask(struct unrefract_survey *survey, const float *seen, const struct told *told, const double white[3], const struct sheet *sheet,
                    const struct unrefract_conf *conf);

#endif
