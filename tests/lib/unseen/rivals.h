/* rivals: other methods' answers to a photograph of an eye (tests/peers), each on the size that its authors would run it on. */
#ifndef TESTS_UNSEEN_RIVALS_H
#define TESTS_UNSEEN_RIVALS_H
#include "tests/lib/unseen/answer.h"

enum rival { RIVAL_RADIAL, RIVAL_HOUGH, RIVAL_INTEGRO, RIVAL_SWIRSKI, RIVALS };
extern const char *const rival_name[RIVALS];

void rival_answer(struct answer *out, enum rival rival, const struct photo *photo);

#endif
