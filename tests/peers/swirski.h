/* swirski: the pupil tracker of Swirski, Bulling and Dodgson (Robust real-time pupil tracking in highly off-axis images, ETRA 2012),
 * written from the paper, with the radii of an iris instead of a pupil's: a centre-surround feature on the integral image, a threshold
 * between two means of the histogram, edges of the dark region, RANSAC for an ellipse whose support knows the gradients.
 */
#ifndef PEERS_SWIRSKI_H
#define PEERS_SWIRSKI_H
#include <stdbool.h>
#include <stdint.h>

#include "math/ellipse_type.h"

/* grey: [height][width]. Radii from r_min to r_max px. False: no ellipse has support. */
bool swirski_ellipse(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max);

#endif
