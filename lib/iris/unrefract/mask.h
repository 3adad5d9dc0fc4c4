/* mask: the weights of a survey: lids, lashes, reflections, pupil and what is hidden get none. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_MASK_H
#define IRIS_UNREFRACT_MASK_H
#include "iris/unrefract/rings.h"

/* Fills survey's weight, lid_share and glint_share from its rgb.
 * seen  [size][size] 1 where the photograph shows the texel */
void unrefract_mask(struct unrefract_survey *survey, const float *seen, const struct sheet *sheet,
                    const struct unrefract_conf *conf);

#endif
