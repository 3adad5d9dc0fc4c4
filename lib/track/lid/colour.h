/* lid_colour: what colours the eye has and what colours its lids, learnt from the clip itself as the lids are found.
 */
#ifndef TRACK_LID_COLOUR_H
#define TRACK_LID_COLOUR_H
#include "track/lid/chart.h"

enum { LID_LIGHT = 18, LID_RED = 28, LID_BLUE = 20, LID_BINS = LID_LIGHT * LID_RED * LID_BLUE };
enum { LID_THIRDS = 3, LID_RINGS = 7, LID_ZONES = LID_THIRDS + LID_RINGS };

struct lid_colour {
	float seen[LID_ZONES][LID_BINS];     // how often: lids by third of the columns, then the eye by rings about the iris
	float says[LID_ZONES][LID_BINS];     // log of how likely that is there
	double frames;                       // learnt from, older ones counting less
};
static const float LID_SURE = 2.5F;  // either way

/* Brightness on a logarithmic scale, and two differences of colour over brightness: light that falls off moves the first alone. < LID_BINS. */
int lid_colour_bin(const uint8_t rgb[3]);

/* Log of how likely each colour is by how often it was seen, neighbours smoothed; what was hardly ever seen says nothing. */
void lid_colour_log(float says[LID_BINS], const float seen[LID_BINS]);

/* The limbus on the chart: column, row, radius in columns and rows; not known where a radius is not positive. What colour an iris has depends on how far
 * from the pupil it is, and is much the same all round: what the lids never show of it is known from what they do. */
struct lid_iris {
	double col, row, cols, rows;
};

/* Adds a chart whose margins lie at rows upper[cols], lower[cols]; lower <= upper: shut there. Cells count that are at least
 * clear[0] rows outside (lids) or clear[1] inside the margins (eye); lids' no further than `band` rows from one. keep: what
 * the past counts for. */
void lid_colour_learn(struct lid_colour *colour, const struct lid_chart *chart, const double upper[],
                      const double lower[], const struct lid_iris *iris, const double clear[2], double band,
                      double keep);

/* says[] from seen[]. */
void lid_colour_settle(struct lid_colour *colour);

/* The odds of every cell. */
void lid_colour_ask(float odds[LID_ROWS][LID_COLS_MAX], const struct lid_colour *colour, const struct lid_chart *chart,
                    const struct lid_iris *iris);

#endif
