/* tally: what methods make of unseen eyes, counted by lids, light, size and tilt. */
#ifndef TESTS_UNSEEN_TALLY_H
#define TESTS_UNSEEN_TALLY_H
#include "tests/lib/unseen/answer.h"

struct verdict {
	bool ran, ok, right;
	double rough;          // not ok, but known to this share of a; 0: to none
	bool has_pupil, pupil_wrong;  // wrong: off by more than a tenth of the limbus's a
	double error, share;   // ellipse_apart px, and over the true a; of rough ones, too
	double ratio[4];       // error over sigma of cx, cy, a, b; NAN: the method states no sigma
	double tilt, tilt_ratio, weak;  // degrees off the true theta; over its sigma; the same of arccos(b / a)
	double seconds;
	struct ellipse e;
	char reason[96];
};

enum { METHODS_MAX = 8 };

struct outcome {
	int number, width, height;
	enum unseen_maker maker;
	struct unseen_eye eye;  // the one that was asked for
	double opening, warmth;
	struct verdict by[METHODS_MAX];
};

/* Describes a photograph; the verdicts are left as they are. */
void outcome_of(struct outcome *o, int number, const struct unseen *u);
/* Judges one method's answer. An answer may mean either eye of a face. */
struct verdict verdict_of(const struct answer *a, const struct unseen *u);

struct tally {
	int n, right, near, wrong, refused, half, half_found;  // near: within 5 % of a; half: with half of the limbus showing
	int rough, rough_off, half_rough;  // refused, but known to at most ANSWER_ROUGH; of these off by more than they say; of half-showing ones, not off
	int pupils, pupils_wrong;                         // of the right ones
	double median_px, ratio90, tilt_ratio90, tilt_median, weak_median;  // error px: of right ones; ratios: of all that are ok
	double rough_ratio90, rough_tilt_ratio90;         // of all that are known roughly
	double seconds;                                   // median
};

enum { TALLY_BINS = 17 };
extern const char *const tally_bin[TALLY_BINS];
bool tally_in(int bin, const struct outcome *o);
struct tally tally_make(int n, const struct outcome *o, int method, int bin);

/* OUT/limbus_unseen.cases.txt: a line a photograph and method. False when it cannot be written. */
bool tally_csv(const char *path, int n, const struct outcome *o, int methods, const char *const name[]);

#endif
