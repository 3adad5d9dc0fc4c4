/* track_units: errors of the strengths of expressions (action units) by `track`, against a rendered clip's truth. */
#ifndef TESTS_TRACK_UNITS_H
#define TESTS_TRACK_UNITS_H
#include "tests/lib/score/track_score.h"

/* Neutral and peak frame of a unit of the truth's au_names, as a person who looks through the clip would mark them. False: it is not
 * shown. truth: folder of truth.npz and truth.json. */
bool track_units_mark(int frame[2], const char *truth, const char *unit);

/* |strength - truth's| of column au1, au2, ... of the capture's gaze.csv: of units[n] in that order, all frames. The truth's strength is
 * its weight, 0 at the neutral frame and 1 at the peak. shown: where the truth is above a half; rest: where it is below 0.02. */
bool track_units_score(struct spread *all, struct spread *shown, struct spread *rest, const char *dir, const char *truth, int n,
                       const char *const units[], struct err *err);

#endif
