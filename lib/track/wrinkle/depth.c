/* Depth of a line: the groove whose shading, in the light of the neutral face, fits its profiles (shape from shading). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "math/chol.h"
#include "math/stats.h"
#include "math/vec.h"
#include "track/wrinkle/impl.h"

enum { SAMPLES = 25, SLOPES = 20, WIDTHS = 4, SHIFTS = 3, ACROSS = 160 };

static const double reach = 3;       // of a profile, in w
static const double low_slope = 0.03;
static const double shift_most = 1.2;  // of w: light from one side darkens one wall, not the bottom
static const double wider = 1.8;     // than the ridge says, or narrower, at most
static const double explained = 0.6; // of the profile's variance, by a groove

double wrinkle_sky(double s, double slope)
{
	// Horizon on either side: the steepest line of sight to the groove's own wall. Interreflection is neglected.
	double here = -slope * exp(-0.5 * s * s), rise[2] = { 0, 0 };
	for (int side = 0; side < 2; side++)
		for (int i = 1; i <= 48; i++) {
			double d = 0.08 * i, x = s + (side ? -d : d), up = -slope * exp(-0.5 * x * x) - here;
			rise[side] = fmax(rise[side], up / d);
		}
	// Even sky over a 2D valley, received by the tilted skin: mean cosine over the open angle.
	double tilt = slope * s * exp(-0.5 * s * s), norm = hypot(1, tilt), n[2] = { -tilt / norm, 1 / norm };
	double a = atan2(1, rise[0]), b = atan2(1, rise[1]);  // from straight up
	return fmax(0, 0.5 * (n[1] * (sin(a) + sin(b)) + n[0] * (cos(b) - cos(a))));
}

/* Grooves of every slope, at s / w = reach wider (2 k / (ACROSS - 1) - 1). */
struct wrinkle_grooves {
	double slope[SLOPES];
	float sky[SLOPES][ACROSS], tilt[SLOPES][ACROSS], up[SLOPES][ACROSS];
};

struct wrinkle_grooves *wrinkle_grooves_new(double most)
{
	struct wrinkle_grooves *t = mem_new(1, sizeof *t);
	for (int j = 0; j < SLOPES; j++) {
		t->slope[j] = low_slope * pow(most / low_slope, (double)j / (SLOPES - 1));
		for (int k = 0; k < ACROSS; k++) {
			double s = (reach * wider) * (2.0 * k / (ACROSS - 1) - 1), rise = t->slope[j] * s * exp(-0.5 * s * s);
			t->sky[j][k] = (float)wrinkle_sky(s, t->slope[j]);
			t->up[j][k] = (float)(1 / hypot(1, rise));
			t->tilt[j][k] = (float)rise * t->up[j][k];
		}
	}
	return t;
}

/* Change across the line about control point i, shifted by mm; mean over its neighbours. */
static void profile(double out[SAMPLES], const struct wrinkle_line *line, int i, double shift, const float *change, const struct wrinkle_ground *g)
{
	double width = line->point[i].width, total = 0;
	memset(out, 0, SAMPLES * sizeof *out);
	for (int j = i - 1; j <= i + 1; j++) {
		if (j < 0 || j >= line->n)
			continue;
		const struct wrinkle_point *p = &line->point[j];
		double weight = j == i ? 2 : 1;
		total += weight;
		for (int k = 0; k < SAMPLES; k++) {
			double mm = shift + width * reach * (2.0 * k / (SAMPLES - 1) - 1);
			out[k] += weight * plane_sample(change, g->width, g->height, p->px[0] - g->x0 + mm * p->across_px[0], p->px[1] - g->y0 + mm * p->across_px[1]);
		}
	}
	for (int k = 0; k < SAMPLES; k++)
		out[k] /= total;
}

/* Squared residual of a model profile, an offset and a slope beside it fitted. */
static double residual(const double got[SAMPLES], const double model[SAMPLES])
{
	double sum[2] = { 0 }, x2 = 0, left = 0;
	for (int k = 0; k < SAMPLES; k++) {
		double x = k - 0.5 * (SAMPLES - 1), d = got[k] - model[k];
		sum[0] += d / SAMPLES;
		sum[1] += d * x;
		x2 += x * x;
	}
	for (int k = 0; k < SAMPLES; k++) {
		double d = got[k] - model[k] - sum[0] - sum[1] / x2 * (k - 0.5 * (SAMPLES - 1));
		left += d * d;
	}
	return left;
}

/* Light at a control point: its components across the line, along the skin's normal, and ambient. */
struct sight {
	double across, flat, ambient;
};

/* Depth (mm) of the groove of half width `width` that fits a profile sampled for half width `seen` best; left: its squared
 * residual. */
static double fit_depth(double *left, const double got[SAMPLES], const struct sight *sight, const struct wrinkle_grooves *t, double seen,
                        double width)
{
	double e[SLOPES + 1], model[SAMPLES] = { 0 };
	float whole = (float)(sight->ambient + fmax(0, sight->flat));
	int best = 0, at[SAMPLES];
	for (int k = 0; k < SAMPLES; k++) {
		double s = seen / width * reach * (2.0 * k / (SAMPLES - 1) - 1) / (reach * wider);
		at[k] = (int)lround(0.5 * (fmin(1, fmax(-1, s)) + 1) * (ACROSS - 1));
	}
	e[0] = residual(got, model);
	for (int j = 1; j <= SLOPES; j++) {
		const float *sky = t->sky[j - 1], *tilt = t->tilt[j - 1], *up = t->up[j - 1];
		for (int k = 0; k < SAMPLES; k++) {
			float lit = (float)sight->flat * up[at[k]] - (float)sight->across * tilt[at[k]];
			model[k] = (double)logf(fmaxf(0.02f, ((float)sight->ambient * sky[at[k]] + fmaxf(0, lit)) / whole));
		}
		e[j] = residual(got, model);
		best = e[j] < e[best] ? j : best;
	}
	*left = e[best];
	if (!best)
		return 0;
	double x = best - 1;
	if (best > 1 && best < SLOPES) {  // vertex of the parabola through three
		double bend = e[best - 1] - 2 * e[best] + e[best + 1];
		x += bend > 0 ? 0.5 * (e[best - 1] - e[best + 1]) / bend : 0;
	}
	return width * low_slope * pow(t->slope[SLOPES - 1] / low_slope, x / (SLOPES - 1));
}

static bool sight_of(struct sight *sight, const struct wrinkle_point *p, const struct wrinkles *w, const struct wrinkle_ground *g)
{
	struct wrinkle_point hit;
	double normal[3];
	if (!wrinkle_on_surface(&hit, normal, g, p->px))
		return false;
	*sight = (struct sight){ vec_dot(w->from, p->across), vec_dot(w->from, normal), w->ambient };
	if (p->even)
		*sight = (struct sight){ .ambient = 1 };
	return true;
}

/* A groove fitted at a control point (mm), the share of the profile's variance that it explains, and its squared residual. */
struct found {
	double depth, width, shift, share, left;
};

/* The best of a grid of middles and widths round `from`; span: of the middles, mm, and of the widths, a factor. */
static struct found best_of(const struct found *from, int shifts, double shift_span, int widths, double width_span, const struct wrinkle_line *line,
                            int i, const struct sight *sight, const float *change, const struct wrinkle_ground *g, const struct wrinkle_grooves *t)
{
	double got[SAMPLES], flat[SAMPLES] = { 0 }, seen = line->point[i].width;
	struct found best = { .share = -INFINITY };
	for (int step = -shifts; step <= shifts; step++) {
		double shift = from->shift + shift_span * step / shifts;
		profile(got, line, i, shift, change, g);
		double all = residual(got, flat);
		for (int k = -widths; k <= widths; k++) {
			double left, try = from->width * pow(width_span, (double)k / widths), depth = fit_depth(&left, got, sight, t, seen, try);
			if (1 - left / all > best.share)
				best = (struct found){ depth, try, shift, 1 - left / all, left };
		}
	}
	return best;
}

static struct found measure(const struct wrinkle_line *line, int i, const struct wrinkles *w, const float *change, const struct wrinkle_ground *g,
                            const struct wrinkle_grooves *t)
{
	struct found f = { .width = line->point[i].width };
	struct sight sight;
	if (!sight_of(&sight, &line->point[i], w, g))
		return (struct found){ 0 };
	double step = shift_most * f.width / SHIFTS;
	f = best_of(&f, SHIFTS, SHIFTS * step, WIDTHS, wider, line, i, &sight, change, g, t);
	return best_of(&f, 2, 0.67 * step, 2, 1.1, line, i, &sight, change, g, t);
}

double wrinkle_unexplained(const struct wrinkle_line *line, const struct wrinkles *w, const float *change, const struct wrinkle_ground *g,
                           const struct wrinkle_grooves *t)
{
	double *left = mem_new((size_t)line->n + 1, sizeof *left), sum = 0;
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < line->n; i += 2)
		left[i] = measure(line, i, w, change, g, t).left;
	for (int i = 0; i < line->n; i++)
		sum += left[i];
	free(left);
	return sum;
}

static double middle(const struct found *f, int n, int i, int which)
{
	double v[5];
	int m = 0;
	for (int j = i - 2; j <= i + 2; j++)
		if (j >= 0 && j < n)
			v[m++] = which == 0 ? f[j].depth : which == 1 ? f[j].width : f[j].shift;
	return stats_median(m, v);
}

/* Fits all points in the light of the face, or (even) under an even sky; returns the median share of variance explained. */
static double measure_all(struct found *f, struct wrinkle_line *line, bool even, const struct wrinkles *w, const float *change,
                          const struct wrinkle_ground *g, const struct wrinkle_grooves *t)
{
	double *share = mem_new((size_t)line->n + 1, sizeof *share);
	for (int i = 0; i < line->n; i++)
		line->point[i].even = even;
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < line->n; i++)
		f[i] = measure(line, i, w, change, g, t);
	for (int i = 0; i < line->n; i++)
		share[i] = f[i].share;
	double median = stats_median(line->n, share);
	free(share);
	return median;
}

void wrinkle_measure(struct wrinkle_line *line, const struct wrinkles *w, const float *change, const struct wrinkle_ground *g,
                     const struct wrinkle_grooves *t, const struct wrinkle_conf *conf)
{
	struct found *f = mem_new((size_t)line->n + 1, sizeof *f);
	double *width = mem_new((size_t)line->n + 1, sizeof *width), share = measure_all(f, line, false, w, change, g, t);
	if (share < explained)  // the nose or a brow may shade the line
		share = measure_all(f, line, true, w, change, g, t);
	int deep = 0;
	for (int i = 0; i < line->n; i++) {
		struct wrinkle_point *p = &line->point[i];
		double shift = middle(f, line->n, i, 2), normal[3];
		p->depth = middle(f, line->n, i, 0);
		width[i] = p->width = middle(f, line->n, i, 1);
		deep += p->depth > 0;
		for (int k = 0; k < 2; k++)
			p->px[k] += shift * p->across_px[k];
		wrinkle_on_surface(p, normal, g, p->px);
	}
	if (2 * deep < line->n || share < explained || stats_median(line->n, width) > 1.3 * conf->width_mm[1])
		line->n = 0;
	free(f);
	free(width);
}

void wrinkle_follow(struct wrinkle_line *line, int k, const struct wrinkles *w, const float *change, const struct wrinkle_ground *g,
                    const struct wrinkle_grooves *t)
{
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < line->n; i++) {
		const struct wrinkle_point *p = &line->point[i];
		double got[SAMPLES], best = INFINITY;
		struct sight sight;
		if (!sight_of(&sight, p, w, g))
			continue;
		for (int step = -2; step <= 2; step++) {
			double left, shift = 0.25 * p->width * step;
			profile(got, line, i, shift, change, g);
			double d = fit_depth(&left, got, &sight, t, p->width, p->width);
			left += step ? 1e-5 * SAMPLES : 0;  // a faint line keeps its place
			if (left < best) {
				best = left;
				line->depth[(long)k * line->n + i] = (float)d;
				line->shift[(long)k * line->n + i] = (float)shift;
			}
		}
	}
}
