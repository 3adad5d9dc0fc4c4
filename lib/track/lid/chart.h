/* lid_chart: an eye's opening laid out level: columns from the inner towards the outer corner, rows from the brow down,
 * so that both eyes, all sizes and all tilts of the head look alike to what finds the lids.
 * Image  px, centre of the first pixel (0.5, 0.5). Chart: column and row, centres at whole numbers.
 */
#ifndef TRACK_LID_CHART_H
#define TRACK_LID_CHART_H
#include <stdbool.h>
#include <stdint.h>

enum { LID_COLS_MAX = 128, LID_ROWS = 200 };

struct lid_chart {
	int cols;
	double origin[2];          // px of column 0, row 0
	double du[2], dv[2];       // px of one column, of one row; at right angles
	double width;              // px between the corners of the eye
	uint8_t rgb[LID_ROWS][LID_COLS_MAX][3];
};

/* Lays it between the corners (px), `columns` from one to the other and an eighth more at each end, the corners' line at
 * row LID_ROWS / 2; down: roughly where the chin is. False where the corners are nearer than 8 px. */
bool lid_chart_lay(struct lid_chart *chart, int columns, const double inner[2], const double outer[2],
                   const double down[2]);

/* Fills rgb from [height][stride], three bytes a pixel; beyond the picture its edge is repeated. */
void lid_chart_fill(struct lid_chart *chart, const uint8_t *rgb, int stride, int width, int height);

static inline void lid_chart_px(double px[2], const struct lid_chart *chart, double col, double row)
{
	for (int i = 0; i < 2; i++)
		px[i] = chart->origin[i] + col * chart->du[i] + row * chart->dv[i];
}

void lid_chart_of(double *col, double *row, const struct lid_chart *chart, const double px[2]);

/* The column at which a corner was put: 0 inner, 1 outer. */
double lid_chart_corner(const struct lid_chart *chart, int corner);

#endif
