/* path: both margins of an opening on its chart, each the cheapest path through all columns (dynamic programming).
 */
#ifndef TRACK_LID_PATH_H
#define TRACK_LID_PATH_H
#include "track/lid/strip.h"

struct lid_curves {
	double row[2][LID_COLS_MAX];  // upper, lower; lower <= upper: shut in this column
};

struct lid_path_conf {
	double sigma[2];       // rows: standard deviation of the upper, the lower margin about the expected one, midway between the corners
	double certain;        // weight of a cell's log odds
	double bend;           // cost of one row of change of slope against the expected one, squared
	double edge;           // gain of a full edge
	double cross;          // cost of an edge left inside the eye
	double strip;          // cost of a strip (strip.h) that matches in no cell
	int columns[2];        // between the corners of the eye: nothing is open before the first, after the second
	double iris[4];        // limbus on the chart: column, row, radius in columns and rows; NAN: not known
};

/* Costs of both margins by their strips: [j][i], margin between rows j - 1 and j; only rows first..last of each. */
struct lid_match {
	bool known;
	int first[2], last[2];
	float cost[2][LID_ROWS + 1][LID_COLS_MAX];  // 0 .. LID_STRIP_WORST
};

/* odds: log odds of eye against lid of each cell. match: ignored where not known. expect: expected margins and their slopes;
 * may be out itself. The margins are fitted in turns, each given the other. out: rows between cells. Returns the mean odds
 * inside the opening minus that in a rim outside it. */
double lid_path(struct lid_curves *out, const struct lid_chart *chart, float odds[LID_ROWS][LID_COLS_MAX],
                const struct lid_match *match, const struct lid_curves *expect,
                const struct lid_path_conf *conf);

/* Refines columns first..last of whole rows to the parabola's minimum of the strips' cost, a fraction of a row, and smooths.
 * Returns the mean cost before that. */
double lid_path_refine(double row[], const struct lid_match *match, int lower, int first, int last, double bend);

/* Penalised least squares (Whittaker 1923, second differences): out[n] smooths y[n] of weight w[n]; bend: their relative
 * weight. n <= LID_COLS_MAX. */
void lid_smooth(double out[], int n, const double y[], const double w[], double bend);

#endif
