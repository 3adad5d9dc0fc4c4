/* margin: lid margins refined to a fraction of a pixel by step edges in the picture itself, from rough ones on the chart. */
#ifndef TRACK_LID_MARGIN_H
#define TRACK_LID_MARGIN_H
#include "track/lid/corner.h"
#include "track/lid/path.h"

struct lid_margin_conf {
	double reach;          // px searched on either side
	double wet;            // px from the visible eye out to the edge of the lid: the tear meniscus
	double bend;           // smoothing, as lid_smooth
};

/* Moves columns first..last of curve `lower` (0 upper, 1 lower) onto the step edge across it, with Tukey weights along the curve.
 * Returns the mean clarity of the edge over the columns, 0..1. */
double lid_margin_settle(struct lid_curves *curves, int lower, int first, int last, const struct lid_chart *chart,
                         const struct lid_picture *picture, const struct lid_margin_conf *conf);

/* First and last column of the longest run that is open by more than `gap` rows. Returns false when it has fewer than five
 * columns (shut). */
bool lid_opening(int *first, int *last, const struct lid_curves *curves, int cols, double gap);

/* n points (px) at equal arc lengths along a margin, from corner to corner (chart column and row). */
void lid_points(double p[][2], int n, const struct lid_curves *curves, int lower, int first, int last,
                const double corner[2][2], const struct lid_chart *chart);

#endif
