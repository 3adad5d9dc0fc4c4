/* colour_means: classes of pixels by k-means over colour and place, the plain statistical rival of a trained network.
 * What class a cluster is, it is told by the truth: the best that any rule for naming clusters could reach.
 */
#ifndef PEERS_COLOUR_MEANS_H
#define PEERS_COLOUR_MEANS_H
#include <stdint.h>

/* out: [height][width] classes below n_classes. rgb: three planes [height][width], encoded, 0..1. truth: the same size as out.
 * place: weight of a picture's width beside a colour of 1. Lloyd's iterations from clusters that share the brightness out. */
void colour_means(uint8_t *out, const float *rgb, const uint8_t *truth, int width, int height, int clusters, double place, int n_classes);

#endif
