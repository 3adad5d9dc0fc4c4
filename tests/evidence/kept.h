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

/* A file of them, for lessons that go round and round in it, from some place on. Ends the program where it cannot be read. */
FILE *kept_open(const char *path, uint64_t first);

/* The next one that shows an eye, more than so much of its limbus; from the beginning again at the file's end. eye: the one that shows most of it.
 * False: none does. drawn_free. */
bool kept_next_eye(struct drawn *drawn, const struct drawn_eye **eye, FILE *file, float shown);

#endif
