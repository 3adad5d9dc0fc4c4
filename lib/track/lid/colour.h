/* colour: colour histograms of eye and lids, learnt from the clip itself as the lids are found, and log odds of eye against
 * lid. */
#ifndef TRACK_LID_COLOUR_H
#define TRACK_LID_COLOUR_H
#include "track/lid/chart.h"

enum { LID_LIGHT = 18, LID_RED = 28, LID_BLUE = 20, LID_BINS = LID_LIGHT * LID_RED * LID_BLUE };
enum { LID_THIRDS = 3, LID_RINGS = 7, LID_ZONES = LID_THIRDS + LID_RINGS };

struct lid_colour {
	float seen[LID_ZONES][LID_BINS];     // counts: lids by third of the columns, then the eye by rings about the iris
	float says[LID_ZONES][LID_BINS];     // log likelihood of each colour there
	double frames;                       // learnt from; older ones weigh less
};
static const float LID_SURE = 2.5F;  // log odds are clamped to this

/* Bin of a colour, < LID_BINS: brightness on a logarithmic scale, and two colour differences over brightness; dimmer light
 * changes the first alone. */
int lid_colour_bin(const uint8_t rgb[3]);

/* Log likelihood of each colour from counts, smoothed over neighbouring bins; a floor keeps colours hardly ever seen from
 * deciding. */
void lid_colour_log(float says[LID_BINS], const float seen[LID_BINS]);

/* The limbus on the chart: column, row, radius in columns and rows; unknown where a radius is not positive. The colour of an
 * iris depends on the distance
 * from the pupil and is much the same all round: parts always covered by lids are known from those that are seen. */
struct lid_iris {
	double col, row, cols, rows;
};

/* Adds a chart whose margins lie at rows upper[cols], lower[cols]; lower <= upper: shut there. Lid cells count from clear[0] to
 * `band` rows outside a margin, eye cells from clear[1] rows inside. Earlier counts are multiplied by keep. */
void lid_colour_learn(struct lid_colour *colour, const struct lid_chart *chart, const double upper[],
                      const double lower[], const struct lid_iris *iris, const double clear[2], double band,
                      double keep);

/* Computes says from seen. */
void lid_colour_settle(struct lid_colour *colour);

/* Log odds of eye against lid for every cell, within +- LID_SURE. */
void lid_colour_ask(float odds[LID_ROWS][LID_COLS_MAX], const struct lid_colour *colour, const struct lid_chart *chart,
                    const struct lid_iris *iris);

#endif
