/* unseen: photographs of eyes to judge by, with exact ellipses: irises, skins, lids and lights that had no part in development.
 * Seven in ten are drawn by the generator of tests/evidence, test split (UNSEEN_DRAWN), the others by a ray caster that shares no code
 * with it (UNSEEN_CAST, tests/lib/cast). Photographs are 300 to 1600 px long, the limbus's semi-axis 30 to 500 px, wholly in the frame.
 */
#ifndef TESTS_UNSEEN_H
#define TESTS_UNSEEN_H
#include "image/photo/photo.h"
#include "math/ellipse.h"

enum unseen_maker { UNSEEN_DRAWN, UNSEEN_CAST, UNSEEN_TRACED, UNSEEN_HEADS };

struct unseen_eye {
	struct ellipse limbus;  // px: the middle of its ramp, in linear light
	struct ellipse pupil;   // as the cornea shows it, good to some per cent
	double showing;         // share of the limbus that no lid, lash, reflection or edge of the picture hides
	double theta;           // radians between the optical axis and the direction to the camera
};

struct unseen {
	struct photo photo;
	int n;                  // eyes in the picture; the first is the one that was asked for
	struct unseen_eye eye[2];
	enum unseen_maker maker;
	double opening;         // of the lids, over the limbus's diameter
	double warmth;          // red over blue of what is white, in linear light: 1 balanced, tungsten light left as it is near 3
	double white[3];        // of a drawn face: linear colour in which a white surface is shown
	double aspect;          // vertical over horizontal diameter as told to the program; NAN: not told
	bool leans;             // what is told as vertical is not, by more than 6 degrees, and the limbus no circle: its outline does not tell the tilt
};

/* Photograph i of the split made from `seed`: the same on every machine. unseen_free. Not for several threads at once. */
struct unseen unseen_make(uint64_t seed, int i);
/* The same of a width and height of the caller's. */
struct unseen unseen_sized(uint64_t seed, int i, int width, int height);
void unseen_free(struct unseen *u);

/* How many photographs $EYEWRIGHT_TRACED holds: a folder of captures with truth (lib/truth/truth.h) that a path tracer has made; each
 * counts twice, as it is and in tungsten light. 0 where it is not set. */
int unseen_traced_count(void);
/* Photograph k of them. False: its truth or picture cannot be read. */
bool unseen_traced(struct unseen *u, int k);

/* How many photographs $EYEWRIGHT_HEADS holds, a file that tests/evidence/heads.py has written of people whom training has not seen. 0 where it is
 * not set. */
int unseen_heads_count(void);
/* Photograph k of them; no pupil is known. False: it shows hardly any eye. */
bool unseen_heads(struct unseen *u, int k);

/* The split's size. */
enum { UNSEEN_COUNT = 1000 };

#endif
