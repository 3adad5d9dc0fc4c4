/* saliency_pick: the next place to look at on a saliency map: the maximum, with inhibition of return (Itti, Koch and Niebur
 * 1998). Places are shares of the picture's width and height, 0..1 from the top left.
 */
#ifndef IMAGE_SALIENCY_PICK_H
#define IMAGE_SALIENCY_PICK_H
#include "image/saliency.h"

/* The place of the highest saliency times (1 - inhibition). False, at the middle, where the map is flat. */
bool saliency_next(double at[2], const struct saliency *s);

/* Inhibits a disk about a place; beyond its radius (share of the map's shorter side) the inhibition falls like a Gaussian. */
void saliency_inhibit(struct saliency *s, const double at[2], double radius);

/* Multiplies all inhibition by exp(-seconds / tau); tau in seconds. */
void saliency_decay(struct saliency *s, double seconds, double tau);

#endif
