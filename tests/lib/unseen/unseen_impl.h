/* What the makers of unseen eyes share. */
#ifndef TESTS_UNSEEN_IMPL_H
#define TESTS_UNSEEN_IMPL_H
#include "math/rng.h"
#include "tests/lib/unseen/unseen.h"

/* How large, and where the eye is. */
struct unseen_frame { int width, height; double radius, x, y, turn; bool mirrored; };

/* A photograph of 8-bit pixels, which are copied. */
struct photo unseen_photo(const uint8_t *rgb, int width, int height);

/* Photographs that $UNSEEN_KEEP=DIR keeps between runs, as bytes of this program: drawing takes longer than judging. Whoever changes what
 * draws them empties the folder. False: it is not kept. */
bool unseen_kept(struct unseen *u, uint64_t seed, int i, int width, int height);
void unseen_keep(const struct unseen *u, uint64_t seed, int i, int width, int height);

bool unseen_draw(struct unseen *u, uint64_t number, const struct unseen_frame *f);
/* Share of a limbus (px of the picture) that shows: iris just inside and sclera just outside. */
struct drawn;
double unseen_showing(const struct drawn *d, const struct ellipse *e);
/* Eye k of a drawn picture. */
struct unseen_eye unseen_eye_of(const struct drawn *d, int k);
/* Whether a drawn picture turned by `turn`, radians, leans. */
bool unseen_leans(const struct drawn *d, double turn);

bool unseen_cast(struct unseen *u, struct rng *rng, const struct unseen_frame *f);

#endif
