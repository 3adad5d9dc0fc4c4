/* Views of one iris laid onto each other: a cornea that is not as the eye's dimensions have it, and a gaze that is a little off, shift, shear and stretch what
 * they show. An affine map is fitted to ln of luminance, by Gauss-Newton with robust weights (Baker and Matthews 2004), from coarse to fine. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/photo/filmed_impl.h"
#include "math/chol.h"

enum { SMALL = SIDE / 4, CELLS = SMALL * SMALL, LEVELS = 2, STEPS = 12, UNKNOWN = 7, COMMON_LEAST = 500 };
static const double sigma[LEVELS] = { 3, 1.2 };  // of the blur, in small texels
static const double farthest = 0.8;              // mm that a place may move
static const double off = 0.25;                  // ln of luminance: what differs by more is another thing

/* ln of luminance and how well it is seen, a quarter as fine. */
struct small {
	float *ln, *weight;   // [CELLS]
};

static struct small small_of(const struct filmed *f, const struct filmed_one *one)
{
	struct small s = { mem_new(CELLS, sizeof *s.ln), mem_new(CELLS, sizeof *s.weight) };
	for (int i = 0; i < TEXELS; i++) {
		const uint8_t *p = one->rgb[i];
		const int to = i / SIDE / 4 * SMALL + i % SIDE / 4;
		const float light = 0.2126f * f->linear[p[0]] + 0.7152f * f->linear[p[1]] + 0.0722f * f->linear[p[2]], w = (float)p[3] / 255;
		s.ln[to] += w * logf(fmaxf(light, 1e-3f));
		s.weight[to] += w;
	}
	for (int i = 0; i < CELLS; i++) {
		s.ln[i] /= fmaxf(s.weight[i], 1e-6f);
		s.weight[i] /= 16;
	}
	return s;
}

static void small_free(struct small *s)
{
	free(s->ln);
	free(s->weight);
}

/* Blurred over what is seen; where that fails nothing is. */
static struct small blurred(const struct small *from, double sd)
{
	struct small s = { mem_new(CELLS, sizeof *s.ln), mem_new(CELLS, sizeof *s.weight) };
	struct err none = { 0 };
	float (*both)[2] = mem_array(CELLS, sizeof *both);
	for (int i = 0; i < CELLS; i++) {
		both[i][0] = from->weight[i] * from->ln[i];
		both[i][1] = from->weight[i];
	}
	const bool ok = cv_blur(&both[0][0], &both[0][0], SMALL, SMALL, 2, sd, &none);
	for (int i = 0; i < CELLS && ok; i++) {
		s.ln[i] = both[i][1] > 1e-6f ? both[i][0] / both[i][1] : 0;
		s.weight[i] = from->weight[i] > 0 ? both[i][1] : 0;
	}
	free(both);
	return s;
}

/* Value and slopes at a place; false where it is not seen all round. */
static bool sample(double out[3], const struct small *s, double x, double y)
{
	const int i = (int)floor(x), j = (int)floor(y);
	if (i < 0 || j < 0 || i + 1 >= SMALL || j + 1 >= SMALL)
		return false;
	const int at = j * SMALL + i;
	const double fx = x - i, fy = y - j, a = (double)s->ln[at], b = (double)s->ln[at + 1], c = (double)s->ln[at + SMALL], d = (double)s->ln[at + SMALL + 1];
	if (!(s->weight[at] > 0 && s->weight[at + 1] > 0 && s->weight[at + SMALL] > 0 && s->weight[at + SMALL + 1] > 0))
		return false;
	out[0] = (1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d);
	out[1] = (1 - fy) * (b - a) + fy * (d - c);
	out[2] = (1 - fx) * (c - a) + fx * (d - b);
	return true;
}

/* A step of Gauss-Newton for a and the gain g. Returns the mean weighted square of what is left; NAN: too little in common. */
static double step(double a[2][3], double *g, const struct small *base, const struct small *view, double extent)
{
	const double mm = 2 * extent / SMALL;
	double H[UNKNOWN * UNKNOWN] = { 0 }, r[UNKNOWN] = { 0 }, sum = 0, all = 0;
	int n = 0;
	for (int i = 0; i < CELLS; i++) {
		const double x = (i % SMALL + 0.5) * mm - extent, y = (i / SMALL + 0.5) * mm - extent;
		double v[3];
		if (!(base->weight[i] > 0) || !sample(v, view, (a[0][0] * x + a[0][1] * y + a[0][2] + extent) / mm - 0.5, (a[1][0] * x + a[1][1] * y + a[1][2] + extent) / mm - 0.5))
			continue;
		const double e = (double)base->ln[i] - v[0] - *g, w = (double)base->weight[i] / (1 + e * e / (off * off)), gx = v[1] / mm, gy = v[2] / mm;
		const double row[UNKNOWN] = { gx * x, gx * y, gx, gy * x, gy * y, gy, 1 };
		for (int p = 0; p < UNKNOWN; p++) {
			r[p] += w * row[p] * e;
			for (int q = 0; q < UNKNOWN; q++)
				H[p * UNKNOWN + q] += w * row[p] * row[q];
		}
		sum += w * e * e;
		all += w;
		n++;
	}
	if (n < COMMON_LEAST)
		return NAN;
	// Damped (Levenberg): what is seen of an iris may be too smooth to tell all six.
	for (int p = 0; p < 6; p++)
		H[p * UNKNOWN + p] *= 1.01;
	if (!chol_solve(UNKNOWN, UNKNOWN, H, r))
		return NAN;
	for (int p = 0; p < 6; p++)
		a[p / 3][p % 3] += r[p];
	*g += r[6];
	return sum / all;
}

/* Whether no place of the iris moves too far. */
static bool sane(double a[2][3], double radius)
{
	for (int t = 0; t < 8; t++) {
		const double x = radius * cos(t * M_PI / 4), y = radius * sin(t * M_PI / 4);
		if (!(hypot(a[0][0] * x + a[0][1] * y + a[0][2] - x, a[1][0] * x + a[1][1] * y + a[1][2] - y) < farthest))
			return false;
	}
	return true;
}

static void align(struct filmed_one *one, const struct small base[LEVELS], const struct small *raw, const struct filmed *f)
{
	double a[2][3], g = 0;
	bool ok = true;
	memcpy(a, one->a, sizeof a);
	for (int l = 0; l < LEVELS && ok; l++) {
		struct small view = blurred(raw, sigma[l]);
		for (int k = 0; k < STEPS && ok; k++)
			ok = isfinite(step(a, &g, &base[l], &view, f->extent)) && sane(a, f->eye.limbus_radius);
		small_free(&view);
	}
	one->astray = !ok;
	if (ok)
		memcpy(one->a, a, sizeof one->a);
}

void filmed_align(struct filmed *f)
{
	double most = -1;
	int best = 0;
	for (int k = 0; k < f->n; k++) {
		double sum = 0;
		for (int i = 0; i < TEXELS; i++)
			sum += f->view[k].rgb[i][3];
		if (sum > most) {
			most = sum;
			best = k;
		}
	}
	const struct filmed_one first = f->view[best];
	f->view[best] = f->view[0];
	f->view[0] = first;
	struct small raw = small_of(f, &f->view[0]), base[LEVELS];
	for (int l = 0; l < LEVELS; l++)
		base[l] = blurred(&raw, sigma[l]);
	small_free(&raw);
#pragma omp parallel for schedule(dynamic)
	for (int k = 1; k < f->n; k++) {
		struct small view = small_of(f, &f->view[k]);
		align(&f->view[k], base, &view, f);
		small_free(&view);
	}
	for (int l = 0; l < LEVELS; l++)
		small_free(&base[l]);
}
