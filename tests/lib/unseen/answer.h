/* answer: what the program says of a photograph, as the stage `limbus` measures it with the defaults of config/, and what it is worth. */
#ifndef TESTS_UNSEEN_ANSWER_H
#define TESTS_UNSEEN_ANSWER_H
#include "limbus/find.h"
#include "tests/lib/unseen/unseen.h"

#define ANSWER_ROUGH 0.06  // limbus.rough_used

struct answer {
	bool ok;
	double rough;                // refused, but known to this share of a; 0: to none
	char reason[256];
	struct ellipse e;            // where it is refused, the likeliest one; a 0: none
	bool has_pupil;
	struct ellipse pupil;
	double sigma[ELLIPSE_N];     // of cx, cy, a, b, angle
	double theta, theta_sigma;   // radians; NAN where there is no pose
	double weak;                 // arccos(b / a): the paper's own way, eq. 9
	double seconds;
};

/* What answer_ours measures with, to be changed for a measurement. */
struct limbus_conf *answer_conf(void);

/* aspect: told as eye.limbus_aspect; NAN: nothing told. */
void answer_ours(struct answer *out, const struct photo *photo, double aspect);

/* The same of a photograph that may show both eyes: returns how many; of two, out[0] is the person's left one. */
int answer_face(struct answer out[2], const struct photo *photo, double aspect, bool mirrored);

/* The eye of the photograph that an ellipse is nearest to, by ellipse_apart over a. */
const struct unseen_eye *answer_meant(const struct ellipse *got, const struct unseen *u);

/* How far a right answer may be off, of a: as far as the program allows. */
double answer_right(void);

#endif
