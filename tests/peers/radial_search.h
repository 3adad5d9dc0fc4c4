/* radial_search: the plain way to the iris, never tuned: of each radius the disc that is darkest against its two sides, from it the
 * strongest dark-to-bright steps along rays to the sides, an ellipse through those; the one that most rays agree on, with contrast, again
 * at full size. A baseline for the limbus.
 */
#ifndef PEERS_RADIAL_SEARCH_H
#define PEERS_RADIAL_SEARCH_H
#include <stdbool.h>
#include <stdint.h>

#include "math/ellipse_type.h"

/* grey: [height][width]. Radii from r_min to r_max px. False: too few rays agree on an ellipse. */
bool radial_search(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max);

/* Means of n x n px of a picture; *out: [height / n][width / n], free(). */
void radial_shrink(uint8_t **out, const uint8_t *grey, int width, int height, int n);

#endif
