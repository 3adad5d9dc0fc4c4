/* lid_margin: the margins of an opening to a fraction of a pixel, in the picture itself, from rough ones on its chart.
 */
#ifndef TRACK_LID_MARGIN_H
#define TRACK_LID_MARGIN_H
#include "track/lid/corner.h"
#include "track/lid/path.h"

struct lid_margin_conf {
	double reach;          // px searched on either side
	double wet;            // px that the edge of the lid lies outside what is seen of the eye: the tear meniscus
	double bend;           // of lid_smooth, in columns
};

/* Moves rows first..last of curve `lower` onto the margin. weight[cols] (may be null): how clear the edge is, 0 none.
 * Returns the mean share of columns that show one. */
double lid_margin_settle(struct lid_curves *curves, int lower, int first, int last, const struct lid_chart *chart,
                         const struct lid_picture *picture, const struct lid_margin_conf *conf);

/* First and last column that is open by more than `gap` rows; the widest such run. False: shut. */
bool lid_opening(int *first, int *last, const struct lid_curves *curves, int cols, double gap);

/* n points at equal distances along a margin, px, from corner to corner (chart column and row). */
void lid_points(double p[][2], int n, const struct lid_curves *curves, int lower, int first, int last,
                const double corner[2][2], const struct lid_chart *chart);

#endif
