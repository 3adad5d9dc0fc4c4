/* kept: photographs with labels and ellipses that heads.py or traced.py has written, as the generator's own are.
 *
 * A file of them holds, one after the other: width, height, number of eyes (three int32); of each eye limbus x, y, semi-axes, angle, share of it
 * that shows, radians to the camera (seven float32); RGB; labels. Bytes as the machine orders them.
 */
#ifndef EVIDENCE_KEPT_H
#define EVIDENCE_KEPT_H
#include <stdio.h>

#include "scene.h"

/* The next one. False: there is none, or it is cut off. drawn_free. */
bool kept_next(struct drawn *drawn, FILE *file);

#endif
