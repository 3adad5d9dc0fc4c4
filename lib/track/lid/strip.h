/* strip: appearance of a lid in a strip along its margin: mean and variance of every cell over the clip. Skin moves with the
 * margin and keeps its appearance, the eye behind it does not. The strip therefore locates the lid in any frame, and the eye
 * begins where the variance rises.
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

/* cost[j][i]: mismatch with the margin between rows j - 1 and j of column i, for rows first..last. Mean over the strip's cells:
 * outside the margin squared difference over expected variance, at most LID_STRIP_WORST; in a few cells inside, LID_STRIP_WORST
 * less that, since they must not look like the lid's rim. */
void lid_strip_cost(float cost[LID_ROWS + 1][LID_COLS_MAX], const struct lid_strip *strip, const struct lid_chart *chart,
                    int first, int last);
static const float LID_STRIP_WORST = 4;

/* Adds a frame to mean and variance, with the margin's curve at rows row[cols]; columns first..last. */
void lid_strip_learn(struct lid_strip *strip, const struct lid_chart *chart, const double row[], int first, int last);

/* out[cols]: rows from the curve out to where the lid begins; weight[cols]: how clearly, 0..1. */
void lid_strip_edge(double out[], double weight[], const struct lid_strip *strip, int cols);

#endif
