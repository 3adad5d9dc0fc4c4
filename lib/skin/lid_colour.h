/* lid_colour: what colours the eye has and what colours its lids, learnt from the clip itself as the lids are found.
 */
#ifndef SKIN_LID_COLOUR_H
#define SKIN_LID_COLOUR_H
#include "skin/lid_chart.h"

enum { LID_LIGHT = 18, LID_RED = 28, LID_BLUE = 20, LID_BINS = LID_LIGHT * LID_RED * LID_BLUE, LID_ZONES = 3 };

struct lid_colour {
	float seen[LID_ZONES][2][LID_BINS];  // how often, by third of the columns: lids, eye
	float says[LID_ZONES][LID_BINS];     // log of the odds for eye, at most LID_SURE either way
	double frames;                       // learnt from, older ones counting less
};
static const double LID_SURE = 2.5;

/* Adds a chart whose margins lie at rows upper[cols], lower[cols]; lower <= upper: shut there. Cells count that are at least
 * clear[0] rows outside (lids) or clear[1] inside the margins (eye); lids' no further than `band` rows from one. keep: what
 * the past counts for. */
void lid_colour_learn(struct lid_colour *colour, const struct lid_chart *chart, const double upper[],
                      const double lower[], const double clear[2], double band, double keep);

/* says[] from seen[]. */
void lid_colour_settle(struct lid_colour *colour);

/* The odds of every cell. */
void lid_colour_ask(float odds[LID_ROWS][LID_COLS_MAX], const struct lid_colour *colour, const struct lid_chart *chart);

#endif
