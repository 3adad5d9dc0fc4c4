#include "track/lid/chart.h"

#include <math.h>

// Shares of the distance between the corners: extent beyond each of them, and from the top to the bottom row.
static const double BEYOND = 0.125, HIGH = 0.8;

bool lid_chart_lay(struct lid_chart *chart, int columns, const double inner[2], const double outer[2],
                   const double down[2])
{
	double dx = outer[0] - inner[0], dy = outer[1] - inner[1], w = hypot(dx, dy);
	if (!(w >= 8) || !(w < 1e5))
		return false;
	chart->cols = (int)lround(fmin(columns, LID_COLS_MAX / (1 + 2 * BEYOND)) * (1 + 2 * BEYOND));
	chart->width = w;
	double across = w * (1 + 2 * BEYOND) / (chart->cols - 1), high = HIGH * w / (LID_ROWS - 1);
	double side = -dy * down[0] + dx * down[1] < 0 ? -1 : 1;
	chart->du[0] = across * dx / w;
	chart->du[1] = across * dy / w;
	chart->dv[0] = -side * high * dy / w;
	chart->dv[1] = side * high * dx / w;
	for (int i = 0; i < 2; i++)
		chart->origin[i] = inner[i] - BEYOND * (outer[i] - inner[i]) - LID_ROWS / 2 * chart->dv[i];
	return true;
}

double lid_chart_corner(const struct lid_chart *chart, int corner)
{
	return (chart->cols - 1) * (corner ? 1 + BEYOND : BEYOND) / (1 + 2 * BEYOND);
}

void lid_chart_fill(struct lid_chart *chart, const uint8_t *rgb, int stride, int width, int height)
{
	// Four samples a cell, further apart across than down: blurs lashes, not lids.
	static const double part[4][2] = { { -0.3, -0.2 }, { 0.1, -0.2 }, { -0.1, 0.2 }, { 0.3, 0.2 } };
	for (int j = 0; j < LID_ROWS; j++) {
		for (int i = 0; i < chart->cols; i++) {
			int sum[3] = { 2, 2, 2 };
			for (int k = 0; k < 4; k++) {
				double p[2];
				lid_chart_px(p, chart, i + part[k][0], j + part[k][1]);
				int x = (int)p[0], y = (int)p[1];
				x = p[0] < 0 ? 0 : x >= width ? width - 1 : x;
				y = p[1] < 0 ? 0 : y >= height ? height - 1 : y;
				const uint8_t *q = rgb + (long)y * stride + 3L * x;
				for (int c = 0; c < 3; c++)
					sum[c] += q[c];
			}
			for (int c = 0; c < 3; c++)
				chart->rgb[j][i][c] = (uint8_t)(sum[c] / 4);
		}
	}
}
