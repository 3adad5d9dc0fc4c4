/* tiles: a contact sheet of photographs with the true ellipse in green and the answer in red, a number on each. */
#ifndef TESTS_UNSEEN_TILES_H
#define TESTS_UNSEEN_TILES_H
#include "image/photo/photo.h"
#include "math/ellipse.h"

struct tiles;
struct tiles *tiles_new(void);
/* Adds what of the photograph both ellipses need; either may be null. No more than some hundreds are kept. */
void tiles_add(struct tiles *tiles, const struct photo *photo, const struct ellipse *truth, const struct ellipse *answer, int number);
/* Writes NAME into the folder of benchmarks, frees. Nothing to show: an older file of the name goes away. */
void tiles_write(struct tiles *tiles, const char *name);

#endif
