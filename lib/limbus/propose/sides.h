/* sides: accepts a limbus by its two sides (flank.h) or by the pupil in its middle, where the search by whiteness is not enough.
 * Internal to limbus_find. */
#ifndef LIMBUS_PROPOSE_SIDES_H
#define LIMBUS_PROPOSE_SIDES_H
#include "limbus/find.h"

/* True where the measured ellipse e agrees in place and size with the one that the sides gave. */
bool limbus_agrees(const struct ellipse *e, const struct ellipse *settled);

/* Measures an ellipse of which little is visible, searching only near `start`, and accepts it when a pupil lies in its middle.
 * rim  out; unchanged on failure */
bool limbus_measure_centred(struct rim *rim, const struct ellipse *start, const struct photo *photo,
                            const struct pyramid *pyramid, const struct limbus_conf *conf);

/* Detects and measures the limbus by its two sides.
 * found   out: limbus and score on success
 * around  an ellipse that was tried before; what lies inside it is its pupil
 * hint    x, y, radius px, or null
 * Returns found->ok. */
bool limbus_measure_flanks(struct limbus_found *found, struct ellipse around, const struct photo *photo,
                           const struct pyramid *pyramid, const double *hint, const struct limbus_conf *conf);

#endif
