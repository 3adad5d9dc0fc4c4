#include "track/lid/corner.h"

#include <math.h>
#include <string.h>

#include "math/simd.h"

// Shares of the distance between the corners: a sample of the patch, and how far outside the corner its middle lies.
static const double SAMPLE = 0.008, BESIDE = 0.04;
// Grey levels of a usual mismatch; standard deviation of a corner's motion, in samples.
static const double NOISE = 6, MOVES = 8;

/* Brightness on a square round the patch, side samples wide. */
static void read_field(uint8_t *out, int side, int which, const struct lid_chart *chart,
                       const struct lid_picture *picture)
{
	double u = hypot(chart->du[0], chart->du[1]), v = hypot(chart->dv[0], chart->dv[1]), step = SAMPLE * chart->width, p[2];
	double beside = (which ? BESIDE : -BESIDE) * chart->width / u;
	lid_chart_px(p, chart, lid_chart_corner(chart, which) + beside, LID_ROWS / 2);
	for (int j = 0; j < side; j++) {
		for (int i = 0; i < side; i++) {
			double a = (i - side / 2) * step / u, b = (j - side / 2) * step / v;
			int x = (int)floor(p[0] + a * chart->du[0] + b * chart->dv[0]);
			int y = (int)floor(p[1] + a * chart->du[1] + b * chart->dv[1]);
			x = x < 0 ? 0 : x >= picture->width ? picture->width - 1 : x;
			y = y < 0 ? 0 : y >= picture->height ? picture->height - 1 : y;
			const uint8_t *q = picture->rgb + (long)y * picture->stride + 3L * x;
			out[j * side + i] = (uint8_t)((q[0] + 2 * q[1] + q[2] + 2) / 4);
		}
	}
}

SIMD_CLONES static long square(const uint8_t *a, const uint8_t *b)
{
	int sum = 0;
	for (int j = 0; j < CORNER_SIDE; j++)
		for (int i = 0; i < CORNER_SIDE; i++) {
			int d = a[j * CORNER_FIELD + i] - b[j * CORNER_SIDE + i];
			d = d < 0 ? -d : d;
			d = d > 40 ? 40 : d;
			sum += d * d;
		}
	return sum;
}

static double top(double l, double c, double r)
{
	double bend = l - 2 * c + r;
	return bend > 0 ? fmax(-0.5, fmin(0.5, 0.5 * (l - r) / bend)) : 0;
}

void lid_corner_find(double shift[2], struct lid_corner *corner, int which, const struct lid_chart *chart,
                     const struct lid_picture *picture)
{
	enum { N = 2 * CORNER_REACH + 1 };
	shift[0] = shift[1] = 0;
	if (!corner->known) {
		read_field(&corner->look[0][0], CORNER_SIDE, which, chart, picture);
		corner->known = true;
		return;
	}
	static _Thread_local uint8_t field[CORNER_FIELD * CORNER_FIELD];
	double cost[N][N], least = INFINITY;
	int bi = CORNER_REACH, bj = CORNER_REACH;
	read_field(field, CORNER_FIELD, which, chart, picture);
	for (int j = 0; j < N; j++) {
		for (int i = 0; i < N; i++) {
			double off = hypot(i - CORNER_REACH, j - CORNER_REACH) / MOVES;
			// Errors of neighbouring samples are correlated: all count as a dozen.
			double fit = (double)square(&field[j * CORNER_FIELD + i], &corner->look[0][0]) / (CORNER_SIDE * CORNER_SIDE);
			cost[j][i] = 0.5 * 12 * fit / (NOISE * NOISE) + 0.5 * off * off;
			if (cost[j][i] < least)
				least = cost[j][i], bi = i, bj = j;
		}
	}
	// A poor match, as in a blink, is trusted little.
	double fit = (double)square(&field[bj * CORNER_FIELD + bi], &corner->look[0][0]) / (CORNER_SIDE * CORNER_SIDE);
	double strange = fit / (18 * NOISE * NOISE), trust = 1 / (1 + pow(strange, 4));
	double x = bi - CORNER_REACH, y = bj - CORNER_REACH, step = SAMPLE * chart->width;
	if (bi > 0 && bi < N - 1)
		x += top(cost[bj][bi - 1], cost[bj][bi], cost[bj][bi + 1]);
	if (bj > 0 && bj < N - 1)
		y += top(cost[bj - 1][bi], cost[bj][bi], cost[bj + 1][bi]);
	shift[0] = trust * x * step / hypot(chart->du[0], chart->du[1]);
	shift[1] = trust * y * step / hypot(chart->dv[0], chart->dv[1]);
}
