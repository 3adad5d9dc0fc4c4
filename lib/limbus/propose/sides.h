/* sides: */
#ifndef LIMBUS_PROPOSE_SIDES_H
#define LIMBUS_PROPOSE_SIDES_H
#include "limbus/find.h"

/* The blurred step's ellipse says what the sides of the limbus said. */
bool limbus_agrees(const struct ellipse *e, const struct ellipse *settled);

/* An ellipse of which little shows, measured without looking far from where it is thought to be: for what it is its
 * pupil vouches, in its middle. False, rim as it was, where it does not. */
bool limbus_measure_centred(struct rim *rim, const struct ellipse *start, const struct photo *photo,
                            const struct pyramid *pyramid, const struct limbus_conf *conf);

/* The eye by the two sides of its limbus; found->ok. around: what lies inside is the pupil of what was tried before. */
bool limbus_measure_flanks(struct limbus_found *found, struct ellipse around, const struct photo *photo,
                           const struct pyramid *pyramid, const double *hint, const struct limbus_conf *conf);

#endif
