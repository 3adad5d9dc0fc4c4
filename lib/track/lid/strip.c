#include "track/lid/strip.h"

#include <math.h>
#include <string.h>

#include "math/simd.h"

// Grey levels, one sigma: noise and shading of a matching picture; prior spread of a cell inside and outside of the margin.
static const float NOISE = 7, VARIES = 60, KEEPS = 12;
// Frames after which older ones weigh less.
static const float MEMORY = 120;
// A rise of the spread from lid to eye by as many NOISE has weight 1/2.
static const double SURE = 3;

static float doubt(const struct lid_strip *strip, int k, int i3)
{
	float prior = k < LID_STRIP_IN ? VARIES : KEEPS, n = strip->count[i3 / 3];
	return NOISE * NOISE + (strip->var[k][i3] * n + prior * prior * 4) / (n + 4);
}

static int row_of(const struct lid_strip *strip, int j, int k)
{
	int row = strip->lower ? j + k - LID_STRIP_IN : j - 1 - k + LID_STRIP_IN;
	return row < 0 ? 0 : row >= LID_ROWS ? LID_ROWS - 1 : row;
}

SIMD_CLONES static void add_lid(float *sum, const uint8_t *px, const float *mean, const float *per, int n)
{
	for (int i = 0; i < n; i++) {
		float d = (float)px[i] - mean[i], q = d * d * per[i];
		sum[i] += q < LID_STRIP_WORST ? q : LID_STRIP_WORST;
	}
}

/* Reversed: cells inside the margin must not look like the lid. */
SIMD_CLONES static void add_eye(float *sum, const uint8_t *px, const float *rim, const float *per, int n)
{
	for (int i = 0; i < n; i++) {
		float d = (float)px[i] - rim[i], q = d * d * per[i];
		sum[i] += q < LID_STRIP_WORST ? LID_STRIP_WORST - q : 0;
	}
}

enum { RIM = 5, WITHIN = 6 };

void lid_strip_cost(float cost[LID_ROWS + 1][LID_COLS_MAX], const struct lid_strip *strip, const struct lid_chart *chart,
                    int first, int last)
{
	float per[LID_STRIP_OUT][LID_COLS_MAX * 3], rim[LID_COLS_MAX * 3], rim_per[LID_COLS_MAX * 3];
	float sum[LID_COLS_MAX * 3];
	int n = 3 * chart->cols;
	for (int i = 0; i < n; i++) {
		float mean = 0, var = 0;
		for (int k = 0; k < LID_STRIP_OUT; k++)
			per[k][i] = 1 / doubt(strip, LID_STRIP_IN + k, i);
		for (int k = 1; k <= RIM; k++)
			mean += strip->mean[LID_STRIP_IN + k][i] / RIM, var += 1 / per[k][i] / RIM;
		rim[i] = mean;
		rim_per[i] = 1 / var;
	}
	for (int j = first; j <= last; j++) {
		memset(sum, 0, sizeof sum);
		for (int k = 0; k < LID_STRIP_OUT; k++)
			add_lid(sum, &chart->rgb[row_of(strip, j, LID_STRIP_IN + k)][0][0], strip->mean[LID_STRIP_IN + k], per[k], n);
		for (int k = 1; k <= WITHIN; k++)
			add_eye(sum, &chart->rgb[row_of(strip, j, LID_STRIP_IN - 1 - k)][0][0], rim, rim_per, n);
		for (int i = 0; i < chart->cols; i++)
			cost[j][i] = (sum[3 * i] + sum[3 * i + 1] + sum[3 * i + 2]) / (3 * (LID_STRIP_OUT + WITHIN));
	}
}

void lid_strip_learn(struct lid_strip *strip, const struct lid_chart *chart, const double row[], int first, int last)
{
	for (int i = first; i <= last; i++) {
		float n = strip->count[i], rate = 1 / (fminf(n, MEMORY) + 1);
		for (int k = 0; k < LID_STRIP; k++) {
			double at = strip->lower ? row[i] + 0.5 + k - LID_STRIP_IN : row[i] - 0.5 - k + LID_STRIP_IN;
			at = fmin(fmax(at, 0), LID_ROWS - 1.001);
			int j = (int)at;
			float f = (float)(at - j);
			for (int c = 0; c < 3; c++) {
				float v = chart->rgb[j][i][c] + f * (chart->rgb[j + 1][i][c] - chart->rgb[j][i][c]);
				float *mean = &strip->mean[k][3 * i + c], *var = &strip->var[k][3 * i + c], d = v - *mean;
				*mean += rate * d;
				*var += rate * (d * (v - *mean) - *var);
			}
		}
		strip->count[i] = n + 1;
	}
}

/* Standard deviation of a cell over the clip, grey levels, averaged with its neighbours along the margin. */
static double spread(const struct lid_strip *strip, int k, int i, int cols)
{
	double sum = 0;
	int n = 0;
	for (int j = i - 1; j <= i + 1; j++) {
		if (j < 0 || j >= cols || !(strip->count[j] > 0))
			continue;
		n++;
		for (int c = 0; c < 3; c++)
			sum += sqrt(strip->var[k][3 * j + c]) / 3;
	}
	return n ? sum / n : 0;
}

void lid_strip_edge(double out[], double weight[], const struct lid_strip *strip, int cols)
{
	for (int i = 0; i < cols; i++) {
		double v[LID_STRIP], in = 0, skin = 1e9;
		for (int k = 0; k < LID_STRIP; k++)
			v[k] = spread(strip, k, i, cols);
		// The three adjacent cells of least spread are skin; the cell of greatest spread inside them is eye.
		int quiet = 0;
		for (int k = 1; k + 3 < LID_STRIP; k++) {
			double m = (v[k] + v[k + 1] + v[k + 2]) / 3;
			if (m < skin)
				skin = m, quiet = k;
		}
		for (int k = 0; k < quiet; k++)
			in = fmax(in, v[k]);
		double level = skin + 0.07 * (in - skin), rise = (in - skin) / (SURE * NOISE);
		int k = 0;
		while (k < quiet && v[k + 1] >= level)
			k++;
		double f = v[k] > v[k + 1] ? (v[k] - level) / (v[k] - v[k + 1]) : 0;
		out[i] = k + fmin(1, fmax(0, f)) + 0.5 - LID_STRIP_IN;
		rise *= rise * rise;
		weight[i] = strip->count[i] > 8 ? rise / (1 + rise) : 0;
	}
}
