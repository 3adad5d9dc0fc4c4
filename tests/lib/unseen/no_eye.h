/* no_eye: pictures in which no limbus can be measured, or it is not clear whose. */
#ifndef TESTS_UNSEEN_NO_EYE_H
#define TESTS_UNSEEN_NO_EYE_H
#include "tests/lib/unseen/unseen.h"

enum { NO_EYE_BALL, NO_EYE_WHEEL, NO_EYE_BUTTON, NO_EYE_TARGET, NO_EYE_DOLL, NO_EYE_CLUTTER, NO_EYE_FACE, NO_EYE_CLOSED,
	   NO_EYE_MOVED, NO_EYE_CUT, NO_EYE_ANIMAL, NO_EYE_TWO_FACES, NO_EYE_KINDS };
extern const char *const no_eye_kind[NO_EYE_KINDS];

/* Picture i of a kind, made anew from `seed`; photo_free. */
struct photo no_eye_make(uint64_t seed, int kind, int i);

#endif
