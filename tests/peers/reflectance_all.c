/* All orders of isotropic scattering in parallel layers. Optical depth t downwards; the source function J obeys
 *     J(t) = w(t) / 2 integral E1(|t - t'|) J(t') dt' + w(t) / (4 pi cos_light) exp(-t / cos_light)
 * for unit irradiance on the layers (Chandrasekhar, Radiative Transfer, section 11; pi J below). J is split into the first
 * order, which is known, and the rest, taken constant in each cell.
 */
#include <math.h>

#include "tests/peers/reflectance_all.h"

enum { CELLS_ABL = 4, CELLS_STROMA = 14, CELLS = CELLS_ABL + CELLS_STROMA };

/* Third exponential integral, to 2e-7: E1 by the series and the rational fit of Abramowitz and Stegun (5.1.53, 5.1.56),
 * then the recurrence. */
static double e3(double x)
{
	if (x <= 0)
		return 0.5;
	if (x > 40)
		return 0;
	double e = exp(-x), e1;
	if (x < 1) {
		e1 = -log(x) - 0.57721566
		     + x * (0.99999193 + x * (-0.24991055 + x * (0.05519968 + x * (-0.00976004 + x * 0.00107857))));
	} else {
		double p = 0.2677737343 + x * (8.6347608925 + x * (18.0590169730 + x * (8.5733287401 + x)));
		double q = 3.9584969228 + x * (21.0996530827 + x * (25.6329561486 + x * (9.5733223454 + x)));
		e1 = e * p / (q * x);
	}
	return (e * (1 - x) + x * x * e1) / 2;
}

/* Edges of n cells over optical depth `depth`, finer on top the deeper it is: powers found by trying, against 120 cells:
 * mean error 0.2 %, worst 3 % where the stroma is 20 deep. Returns the last. */
static double *cut(double *edge, double from, double depth, int n)
{
	double power = 1 + 0.35 * log1p(depth / 4);
	for (int i = 1; i <= n; i++)
		*++edge = from + depth * pow((double)i / n, power);
	return edge;
}

/* (1 - W K) rest = W K first, by elimination; rows are dominated by their diagonal, because no cell scatters more than it
 * gets. */
static void solve(double a[CELLS][CELLS], double b[CELLS])
{
	for (int k = 0; k < CELLS; k++) {
		for (int i = k + 1; i < CELLS; i++) {
			double f = a[i][k] / a[k][k];
			for (int j = k + 1; j < CELLS; j++)
				a[i][j] -= f * a[k][j];
			b[i] -= f * b[k];
		}
	}
	for (int k = CELLS - 1; k >= 0; k--) {
		for (int j = k + 1; j < CELLS; j++)
			b[k] -= a[k][j] * b[j];
		b[k] /= a[k][k];
	}
}

/* Mean over cell i of half the integral of E1 over cell j. */
static void kernel(double out[CELLS][CELLS], const double edge[CELLS + 1])
{
	double e[CELLS + 1][CELLS + 1];
	for (int i = 0; i <= CELLS; i++)
		for (int j = i; j <= CELLS; j++)
			e[i][j] = e[j][i] = e3(edge[j] - edge[i]);
	for (int i = 0; i < CELLS; i++) {
		double depth = edge[i + 1] - edge[i];
		for (int j = 0; j < CELLS; j++) {
			double sum = i == j ? depth - 0.5 + e[i][i + 1]
			                    : (e[i < j ? i + 1 : i][i < j ? j : j + 1] - e[i][j] - e[i + 1][j + 1]
			                       + e[i < j ? i : i + 1][i < j ? j + 1 : j]) / 2;
			out[i][j] = sum / depth;
		}
	}
}

double tissue_reflectance_all(const double extinction[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl,
                              double stroma, double cos_view, double cos_light)
{
	double edge[CELLS + 1] = { 0 }, k[CELLS][CELLS], a[CELLS][CELLS], first[CELLS], rest[CELLS];
	double depth = extinction[TISSUE_ABL] * abl;
	// A layer of no thickness still needs cells that can be divided by; deeper than 30 nothing comes back.
	double *last = cut(edge, 0, fmin(fmax(depth, 1e-7), 30), CELLS_ABL);
	cut(last, *last, fmin(fmax(extinction[TISSUE_STROMA] * stroma, 1e-7), 30), CELLS_STROMA);
	kernel(k, edge);
	for (int i = 0; i < CELLS; i++)
		first[i] = (exp(-edge[i] / cos_light) - exp(-edge[i + 1] / cos_light)) / (4 * (edge[i + 1] - edge[i]));
	for (int i = 0; i < CELLS; i++) {
		int l = i < CELLS_ABL ? TISSUE_ABL : TISSUE_STROMA;
		double albedo = source[l] / extinction[l];
		rest[i] = 0;
		for (int j = 0; j < CELLS; j++) {
			int m = j < CELLS_ABL ? TISSUE_ABL : TISSUE_STROMA;
			rest[i] += albedo * k[i][j] * first[j] * source[m] / extinction[m];
			a[i][j] = (i == j) - albedo * k[i][j];
		}
	}
	solve(a, rest);
	double sum = tissue_reflectance_one(extinction, source, abl, stroma, cos_view, cos_light);
	for (int i = 0; i < CELLS; i++)
		sum += rest[i] * (exp(-edge[i] / cos_view) - exp(-edge[i + 1] / cos_view));
	return sum;
}
