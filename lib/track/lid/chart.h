/* chart: an eye's opening resampled to a normalised grid: columns from the inner towards the outer corner, rows from the brow down. Both eyes, all
 * sizes and all tilts of the head then look alike to the lid search.
 * Image  px, centre of the first pixel (0.5, 0.5).  Chart  column and row, cell centres at whole numbers.
 */
#ifndef TRACK_LID_CHART_H
#define TRACK_LID_CHART_H
#include <stdbool.h>
#include <stdint.h>

enum { LID_COLS_MAX = 128, LID_ROWS = 200 };

struct lid_chart {
	int cols;
	double origin[2];          // px: centre of column 0, row 0
	double du[2], dv[2];       // px: step of one column, of one row; at right angles
	double width;              // px between the corners of the eye
	uint8_t rgb[LID_ROWS][LID_COLS_MAX][3];
};

/* Sets the geometry from the corners of the eye (px): `columns` from one to the other and an eighth more at each end, the line
 * of corners at row LID_ROWS / 2. down: direction towards the chin, roughly. rgb is left as it was. Returns false when the
 * corners are nearer than 8 px. */
bool lid_chart_lay(struct lid_chart *chart, int columns, const double inner[2], const double outer[2],
                   const double down[2]);

/* Resamples rgb from [height][stride], three bytes a pixel; beyond the picture its border is repeated. */
void lid_chart_fill(struct lid_chart *chart, const uint8_t *rgb, int stride, int width, int height);

/* Chart to image. */
static inline void lid_chart_px(double px[2], const struct lid_chart *chart, double col, double row)
{
	for (int i = 0; i < 2; i++)
		px[i] = chart->origin[i] + col * chart->du[i] + row * chart->dv[i];
}

/* Image to chart. */
static inline void lid_chart_of(double *col, double *row, const struct lid_chart *chart, const double px[2])
{
	const double x = px[0] - chart->origin[0], y = px[1] - chart->origin[1], *u = chart->du, *v = chart->dv;
	*col = (x * u[0] + y * u[1]) / (u[0] * u[0] + u[1] * u[1]);
	*row = (x * v[0] + y * v[1]) / (v[0] * v[0] + v[1] * v[1]);
}

/* Column of a corner of the eye: 0 inner, 1 outer. */
double lid_chart_corner(const struct lid_chart *chart, int corner);

#endif
