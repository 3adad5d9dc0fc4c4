#include "iris/unrefract/pupil.h"

#include <math.h>

#include "iris/unrefract/rings.h"

enum { MARGIN_POINTS = 72 };
static const double LEAST = 0.75, MOST = 4.3;  // mm: radii of pupils, constricted and dilated by drops
static const double BESIDE = 0.4;              // mm to either side of a margin in which the step's levels are taken
static const float FLOOR = 0.02F, COVERED = 0.85F;  // as limbus/pupil.c: no texel is surer; odds of a pupil beneath what covers it

/* Least-squares circle through points (Kasa): x² + y² = 2 cx x + 2 cy y + k, solved about the mean. */
static struct circle circle_fit(int n, const double p[][2])
{
	double mx = 0, my = 0, xx = 0, xy = 0, yy = 0, xr = 0, yr = 0, rr = 0;
	for (int i = 0; i < n; i++) {
		mx += p[i][0] / n;
		my += p[i][1] / n;
	}
	for (int i = 0; i < n; i++) {
		double x = p[i][0] - mx, y = p[i][1] - my, r2 = x * x + y * y;
		xx += x * x, xy += x * y, yy += y * y;
		xr += x * r2, yr += y * r2, rr += r2;
	}
	double det = 2 * (xx * yy - xy * xy);
	double cx = (xr * yy - yr * xy) / det, cy = (yr * xx - xr * xy) / det;
	return (struct circle){ mx + cx, my + cy, sqrt(rr / n + cx * cx + cy * cy) };
}

struct circle pupil_measured(const struct unrefract_view *view)
{
	const struct ellipse *e = &view->fit->pupil;
	double p[MARGIN_POINTS][2];
	int n = 0;
	for (int i = 0; i < MARGIN_POINTS && view->fit->has_pupil; i++) {
		double s = 2 * M_PI * i / MARGIN_POINTS, a = e->a * cos(s), b = e->b * sin(s);
		double px[2] = { e->cx + a * cos(e->angle) - b * sin(e->angle), e->cy + a * sin(e->angle) + b * cos(e->angle) };
		n += iris_see(p[n], 0, &view->iris, px);
	}
	return n < MARGIN_POINTS / 2 ? (struct circle){ 0 } : circle_fit(n, p);
}

/* Radius of a size, mm. */
static double size_of(int i)
{
	return LEAST * pow(MOST / LEAST, i / (PUPIL_SIZES - 1.));
}

/* Where a size would lie. */
static double index_of(double r)
{
	return log(r / LEAST) / log(MOST / LEAST) * (PUPIL_SIZES - 1);
}

/* A place of the survey, mm, from the curve's centre. */
static double away(const struct unrefract_survey *s, const struct pupil_curve *curve, long i)
{
	const double texel = 2 * s->extent / s->size;
	return hypot(((double)(i % s->size) + 0.5) * texel - s->extent - curve->cx, ((double)(i / s->size) + 0.5) * texel - s->extent - curve->cy);
}

/* Middle of what is told to be pupil; far from the axis it is something else that is dark, and believed the less. */
static void centre(struct pupil_curve *curve, const struct told *told, const struct unrefract_survey *s)
{
	const double near = 0.3, texel = 2 * s->extent / s->size;  // mm: pupils lie within 0.3 of the axis (limbus.pupil_offset_sigma), twice over
	double mass = 1, x = 0, y = 0;
	for (long i = 0; i < (long)s->size * s->size && told->pupil; i++) {
		mass += told->pupil[i];
		x += told->pupil[i] * (((double)(i % s->size) + 0.5) * texel - s->extent);
		y += told->pupil[i] * (((double)(i / s->size) + 0.5) * texel - s->extent);
	}
	const double off = hypot(x, y) / mass, share = 1 / (1 + off * off / (near * near));
	curve->cx = share * x / mass;
	curve->cy = share * y / mass;
}

/* Adds the texels' log odds of being pupil within each size, in shares of the iris. */
static void add_told(struct pupil_curve *curve, const float *iris, const struct told *told, const struct unrefract_survey *s, double limbus,
                     const struct unrefract_conf *conf)
{
	const double share = pow(2 * s->extent / s->size / limbus, 2) / M_PI;
	double within[PUPIL_SIZES] = { 0 }, sum = 0;
	for (long i = 0; i < (long)s->size * s->size && told->pupil; i++) {
		const int from = (int)ceil(fmax(index_of(fmax(away(s, curve, i), 1e-3)), 0));
		const float over = told->mirror[i] + told->cover[i], is = told->pupil[i];
		if (from < PUPIL_SIZES && iris[i] + over > 0)
			within[from] += share * (log((is + COVERED * over + FLOOR) / (fmaxf(1 - is, 0) + FLOOR)) + conf->pupil_missed);
	}
	for (int k = 0; k < PUPIL_SIZES; k++) {
		sum += within[k];
		curve->log_p[k] += conf->pupil_told * sum;
	}
}

/* How much brighter the rings are beyond a radius than within it, log. */
static double step_at(const struct rings *rings, double r, double limbus)
{
	double in = 0, out = 0;
	int n_in = 0, n_out = 0;
	for (int k = 0; k < SHEET_RINGS; k++) {
		const double off = limbus * (k + 0.5) / SHEET_RINGS - r;
		if (!isfinite(rings->median[k]) || fabs(off) > BESIDE)
			continue;
		*(off < 0 ? &in : &out) += rings->median[k];
		++*(off < 0 ? &n_in : &n_out);
	}
	return n_in && n_out ? out / n_out - in / n_in : 0;
}

void pupil_curve_of(struct pupil_curve *out, const float *lum, const float *iris, const struct told *told, const struct unrefract_survey *survey,
                    double limbus, const struct unrefract_conf *conf)
{
	*out = (struct pupil_curve){ .known = true };
	centre(out, told, survey);
	const struct sheet disc = { survey->size, survey->extent, { out->cx, out->cy, 0 }, limbus, 0 };
	const struct rings rings = rings_of(lum, iris, &disc, true, 0.1f);
	for (int k = 0; k < PUPIL_SIZES; k++)
		out->log_p[k] = conf->pupil_step * step_at(&rings, size_of(k), limbus);
	add_told(out, iris, told, survey, limbus, conf);
}

/* Logarithm of how usual a size is. */
static double usual(int k, const struct unrefract_conf *conf)
{
	const double off = log(size_of(k) / conf->pupil_usual[0]) / conf->pupil_usual[1];
	return -off * off / 2;
}

/* Likelihoods times priors, summing to 1. prior: conf, or null: any size is as usual. */
static void chances(double p[PUPIL_SIZES], const struct pupil_curve *curve, const struct unrefract_conf *prior)
{
	double top = -INFINITY, sum = 0;
	for (int k = 0; k < PUPIL_SIZES; k++) {
		p[k] = curve->log_p[k] + (prior ? usual(k, prior) : 0);
		top = fmax(top, p[k]);
	}
	for (int k = 0; k < PUPIL_SIZES; k++)
		sum += p[k] = exp(p[k] - top);
	for (int k = 0; k < PUPIL_SIZES; k++)
		p[k] /= sum;
}

struct circle pupil_of_curve(double *log_sigma, const struct pupil_curve *curve, const struct unrefract_conf *conf)
{
	double p[PUPIL_SIZES], mean = 0, square = 0;
	chances(p, curve, conf);
	for (int k = 0; k < PUPIL_SIZES; k++)
		mean += p[k] * log(size_of(k));
	for (int k = 0; k < PUPIL_SIZES; k++)
		square += p[k] * pow(log(size_of(k)) - mean, 2);
	*log_sigma = sqrt(square);
	return (struct circle){ curve->cx, curve->cy, exp(mean) };
}

void pupil_curve_join(struct pupil_curve *curve, const struct pupil_curve *fellow, const struct unrefract_conf *conf)
{
	const double floor = 1e-6, step = log(size_of(1) / size_of(0));
	double p[PUPIL_SIZES];
	chances(p, fellow, 0);
	for (int k = 0; k < PUPIL_SIZES; k++) {
		double sum = floor;
		for (int j = 0; j < PUPIL_SIZES; j++)
			sum += p[j] * exp(-pow((k - j) * step / conf->pupil_fellow, 2) / 2);
		curve->log_p[k] += log(sum);
	}
}

void pupil_curve_at(struct pupil_curve *out, double radius)
{
	const double narrow = 0.05;  // of the logarithm: what measured ones are off by, about
	*out = (struct pupil_curve){ .known = true };
	for (int k = 0; k < PUPIL_SIZES; k++)
		out->log_p[k] = -pow(log(size_of(k) / radius) / narrow, 2) / 2;
}
