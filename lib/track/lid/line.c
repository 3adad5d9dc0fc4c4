#include "track/lid/line.h"

#include <math.h>
#include <string.h>

double line_along(const double p[2], const double from[2], const double to[2])
{
	double d[2] = { to[0] - from[0], to[1] - from[1] };
	return ((p[0] - from[0]) * d[0] + (p[1] - from[1]) * d[1]) / fmax(1e-9, d[0] * d[0] + d[1] * d[1]);
}

void line_nearest(double out[2], const struct line *line, const double p[2])
{
	double least = INFINITY;
	for (int i = 0; i + 1 < line->n; i++) {
		const double *a = line->p[i], *b = line->p[i + 1];
		double t = fmax(0, fmin(1, line_along(p, a, b))), x = a[0] + t * (b[0] - a[0]), y = a[1] + t * (b[1] - a[1]);
		if (hypot(x - p[0], y - p[1]) >= least)
			continue;
		least = hypot(x - p[0], y - p[1]);
		out[0] = x;
		out[1] = y;
	}
}

bool line_passes(double out[2], const struct line *line, double u, const double ends[2][2])
{
	for (int i = 0; i + 1 < line->n; i++) {
		double a = line_along(line->p[i], ends[0], ends[1]), b = line_along(line->p[i + 1], ends[0], ends[1]);
		if (!((a <= u && b > u) || (b <= u && a > u)))
			continue;
		for (int k = 0; k < 2; k++)
			out[k] = line->p[i][k] + (u - a) / (b - a) * (line->p[i + 1][k] - line->p[i][k]);
		return true;
	}
	return false;
}

void line_add(struct line *line, const double p[2])
{
	if (line->n < LINE)
		memcpy(line->p[line->n++], p, sizeof line->p[0]);
}

void line_spread(double (*out)[2], int n, const struct line *line)
{
	double length[LINE] = { 0 };
	for (int i = 1; i < line->n; i++)
		length[i] = length[i - 1] + hypot(line->p[i][0] - line->p[i - 1][0], line->p[i][1] - line->p[i - 1][1]);
	for (int j = 0, i = 0; j < n; j++) {
		double at = length[line->n - 1] * j / (n - 1);
		while (i + 2 < line->n && length[i + 1] < at)
			i++;
		double t = fmin(1, (at - length[i]) / fmax(1e-9, length[i + 1] - length[i]));
		for (int k = 0; k < 2; k++)
			out[j][k] = (1 - t) * line->p[i][k] + t * line->p[i + 1][k];
	}
}
