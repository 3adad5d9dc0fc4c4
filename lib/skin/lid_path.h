/* lid_path: both margins of an opening on its chart, each as the best path through all columns.
 */
#ifndef SKIN_LID_PATH_H
#define SKIN_LID_PATH_H
#include "skin/lid_chart.h"

struct lid_curves {
	double row[2][LID_COLS_MAX];  // upper, lower; lower <= upper: shut in this column
};

struct lid_path_conf {
	double sigma[2];       // rows: how far the upper, the lower margin may be from where it is expected, amid the eye
	double certain;        // what a row of cells is worth, for each unit of its log odds
	double bend;           // cost of one row of change of slope against the expected one, squared
	double edge;           // what a full edge is worth, in rows of certain colour
};

/* odds: log odds of eye against lid of each cell. expect: where the margins are thought to be, and their slopes; may be
 * out itself. Rows are whole numbers. Returns the mean odds inside the opening, minus that in a rim outside it. */
double lid_path(struct lid_curves *out, const struct lid_chart *chart, float odds[LID_ROWS][LID_COLS_MAX],
                const struct lid_curves *expect, const struct lid_path_conf *conf);

/* Penalised least squares (Whittaker 1923, second differences): out[n] smooths y[n] of weight w[n]; bend: their relative
 * weight. n <= LID_COLS_MAX. */
void lid_smooth(double out[], int n, const double y[], const double w[], double bend);

#endif
