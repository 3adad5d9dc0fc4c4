/* flat: freckles of brown irises, found as flat dark patches that hide the fibres. Internal to freckle. */
#ifndef IRIS_FRECKLE_FLAT_H
#define IRIS_FRECKLE_FLAT_H
#include "iris/freckle/search.h"

/* Appends what is found to out->items and marks it in opacity [s->size][s->size], which the caller has zeroed. */
void freckles_find_flat(struct freckles *out, float *opacity, const struct search *s, const struct freckle_conf *conf);

#endif
