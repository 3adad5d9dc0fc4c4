#include "limbus/propose/colour.h"

#include <math.h>
#include <string.h>

#include "math/chol.h"
#include "math/stats.h"

enum { ANGLES = 144, INNER = 4, OUTER = 3 };
static const double inner[INNER] = { 0.80, 0.85, 0.90, 0.94 }, outer[OUTER] = { 1.06, 1.11, 1.17 };
static const double RIDGE = 0.06;    // share of the scatter added to its diagonal
static const double NOISE = 0.004;   // linear light; below this, scatter is the sensor's

struct angle {
	double diff[3], out[3], scatter[3][3];
};

static void sample(double rgb[3], const struct photo *photo, const struct ellipse *e, double t, double scale)
{
	struct ellipse f = *e;
	double p[2], n[2];
	f.a *= scale;
	f.b *= scale;
	ellipse_point(p, n, &f, t);
	photo_colour(rgb, photo, p[0], p[1]);
}

static void add_scatter(double s[3][3], int n, const double rgb[n][3], const double mean[3])
{
	for (int i = 0; i < n; i++)
		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++)
				s[a][b] += (rgb[i][a] - mean[a]) * (rgb[i][b] - mean[b]) / (n - 1);
}

static void look(struct angle *out, const struct photo *photo, const struct ellipse *e, double t)
{
	double in[INNER][3], ex[OUTER][3], mi[3] = { 0 }, me[3] = { 0 };
	for (int i = 0; i < INNER; i++) {
		sample(in[i], photo, e, t, inner[i]);
		for (int c = 0; c < 3; c++)
			mi[c] += in[i][c] / INNER;
	}
	for (int i = 0; i < OUTER; i++) {
		sample(ex[i], photo, e, t, outer[i]);
		for (int c = 0; c < 3; c++)
			me[c] += ex[i][c] / OUTER;
	}
	memset(out, 0, sizeof *out);
	for (int c = 0; c < 3; c++) {
		out->out[c] = me[c];
		out->diff[c] = me[c] - mi[c];
	}
	add_scatter(out->scatter, INNER, in, mi);
	add_scatter(out->scatter, OUTER, ex, me);
}

/* The lower quartile, over the whiter half, of the step along `weight` over the scatter along it. */
static double poorest(const double weight[3], const struct angle angle[ANGLES], const double bright[ANGLES], double median, const double scatter[3][3])
{
	double step[ANGLES], noise = 0;
	int n = 0;
	for (int i = 0; i < ANGLES; i++)
		if (bright[i] >= median)
			step[n++] = weight[0] * angle[i].diff[0] + weight[1] * angle[i].diff[1] + weight[2] * angle[i].diff[2];
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++)
			noise += weight[a] * scatter[a][b] * weight[b];
	return stats_quantile(n, step, 0.25) / sqrt(noise);
}

double limbus_colour(double weight[3], const struct photo *photo, const struct ellipse *e)
{
	struct angle angle[ANGLES];
	double bright[ANGLES], sorted[ANGLES], diff[3] = { 0 }, s[3][3] = { 0 }, scatter[3][3];
	int n = 0;
	for (int i = 0; i < ANGLES; i++) {
		look(&angle[i], photo, e, 2 * M_PI * i / ANGLES);
		bright[i] = fmin(angle[i].out[0], fmin(angle[i].out[1], angle[i].out[2]));
	}
	memcpy(sorted, bright, sizeof sorted);
	double median = stats_median(ANGLES, sorted);
	for (int i = 0; i < ANGLES; i++) {
		if (bright[i] < median)
			continue;
		for (int a = 0; a < 3; a++) {
			diff[a] += angle[i].diff[a];
			for (int b = 0; b < 3; b++)
				s[a][b] += angle[i].scatter[a][b];
		}
		n++;
	}
	double trace = (s[0][0] + s[1][1] + s[2][2]) / 3;
	for (int a = 0; a < 3; a++) {
		diff[a] /= n;
		weight[a] = diff[a];
		s[a][a] += RIDGE * trace + n * NOISE * NOISE;
	}
	memcpy(scatter, s, sizeof s);
	double step = 0;
	if (chol_solve(3, 3, &s[0][0], weight))
		for (int a = 0; a < 3; a++)
			step += weight[a] * diff[a];
	for (int a = 0; a < 3; a++)
		weight[a] = step > 0 ? weight[a] / step : 1.0 / 3;
	const double grey[3] = { 1.0 / 3, 1.0 / 3, 1.0 / 3 };
	const double mine = poorest(weight, angle, bright, median, scatter), plain = poorest(grey, angle, bright, median, scatter);
	return plain > 0 ? mine / plain : INFINITY;
}
