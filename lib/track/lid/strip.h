/* lid_strip: what a lid looks like along its margin, learnt over the clip: skin moves with the margin and keeps its looks,
 * the eye behind does not. So the strip finds the lid again in any frame, and where its looks begin to vary from frame
 * to frame is where the eye begins.
 */
#ifndef TRACK_LID_STRIP_H
#define TRACK_LID_STRIP_H
#include "track/lid/chart.h"

enum { LID_STRIP_IN = 10, LID_STRIP_OUT = 14, LID_STRIP = LID_STRIP_IN + LID_STRIP_OUT };

/* Cell k of a column: row curve + 0.5 + k - LID_STRIP_IN for a lower lid, curve - 0.5 - k + LID_STRIP_IN for an upper. */
struct lid_strip {
	int lower;
	float count[LID_COLS_MAX];
	float mean[LID_STRIP][LID_COLS_MAX * 3], var[LID_STRIP][LID_COLS_MAX * 3];  // grey levels, squared
};

/* What each place of the curve costs: cost[j][i], margin between row j - 1 and j of column i, for rows first..last. Mean
 * over the cells: outside, squared difference over expected variance, at most LID_STRIP_WORST; a few inside, as much
 * where they look like the lid's rim. */
void lid_strip_cost(float cost[LID_ROWS + 1][LID_COLS_MAX], const struct lid_strip *strip, const struct lid_chart *chart,
                    int first, int last);
static const float LID_STRIP_WORST = 4;

/* Adds a frame with the margin's curve at rows row[cols]; columns first..last. */
void lid_strip_learn(struct lid_strip *strip, const struct lid_chart *chart, const double row[], int first, int last);

/* How many rows outside the curve the lid begins, by column; weight: how clearly, 0..1. */
void lid_strip_edge(double out[], double weight[], const struct lid_strip *strip, int cols);

#endif
