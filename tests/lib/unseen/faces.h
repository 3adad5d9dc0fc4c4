/* faces: photographs that show both eyes of a face, with exact ellipses. */
#ifndef TESTS_UNSEEN_FACES_H
#define TESTS_UNSEEN_FACES_H
#include "tests/lib/unseen/unseen.h"

enum { FACES_LEFT, FACES_RIGHT };  // the person's: eye[] of a face's photograph

/* Face i of the split made from `seed`, 640 to 1600 px long, irises of 20 to 80 px radius, both eyes open and wholly in the frame: drawn by
 * the generator of tests/evidence, test split; training: its training split. unseen_free. Not for several threads at once. */
struct unseen faces_make(uint64_t seed, int i, bool training, bool mirrored);

/* How many pictures $EYEWRIGHT_FACES holds: NAME.png beside NAME.truth, of another renderer: a line for each eye, "left" or "right", then
 * limbus cx cy a b angle_deg, share of it that shows, theta_deg, pupil cx cy a b angle_deg. 0 where it is not set. */
int faces_kept_count(void);
/* Picture k of them. False: its truth or picture cannot be read. */
bool faces_kept(struct unseen *u, int k);

#endif
