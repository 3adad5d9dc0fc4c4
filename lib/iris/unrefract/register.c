#include "iris/unrefract/register.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "math/chol.h"

enum { ANGLES = 1440, RINGS = 48, SMALLEST_OVERLAP = 12 };  // overlap in per cent of the rings' cells

void affine_apply(double out[2], const double a[2][3], double x, double y)
{
	out[0] = a[0][0] * x + a[0][1] * y + a[0][2];
	out[1] = a[1][0] * x + a[1][1] * y + a[1][2];
}

float survey_at(const struct unrefract_survey *s, const float *plane, const double p[2])
{
	double to = s->size / (2 * s->extent);
	return plane_sample(plane, s->size, s->size, (p[0] + s->extent) * to, (p[1] + s->extent) * to);
}

/* Local contrast: log brightness minus its local mean, over its local standard deviation; and the local energy of its finest
 * scale. */
void unrefract_detail(struct unrefract_survey *s)
{
	double mm = 2 * s->extent / s->size;
	long n = (long)s->size * s->size;
	s->detail = mem_array((size_t)n, sizeof(float));
	s->sharp = mem_array((size_t)n, sizeof(float));
	float *mean = mem_array((size_t)n, sizeof(float)), *power = mem_array((size_t)n, sizeof(float));
	for (long i = 0; i < n; i++)
		s->detail[i] = mean[i] = s->sharp[i]
			= logf(0.3f * s->rgb[3 * i] + 0.6f * s->rgb[3 * i + 1] + 0.1f * s->rgb[3 * i + 2] + 1e-3f);
	plane_blur_weighted(mean, s->weight, s->size, s->size, 0.35 / mm, 0);
	plane_blur_weighted(s->sharp, s->weight, s->size, s->size, 1, 0);
	for (long i = 0; i < n; i++) {
		float fine = s->weight[i] > 0 ? s->detail[i] - s->sharp[i] : 0;
		s->sharp[i] = fine * fine;
		s->detail[i] = s->weight[i] > 0 ? s->detail[i] - mean[i] : 0;
		power[i] = s->detail[i] * s->detail[i];
	}
	plane_blur_weighted(s->sharp, s->weight, s->size, s->size, 0.35 / mm, 0);
	plane_blur_weighted(power, s->weight, s->size, s->size, 0.7 / mm, 1);
	for (long i = 0; i < n; i++)
		s->detail[i] /= sqrtf(power[i] + 1e-3f);
	free(power);
	free(mean);
}

/* Detail and weight on rings about the axis. */
struct profile {
	float value[RINGS][ANGLES], weight[RINGS][ANGLES];
};

static void take_profile(struct profile *out, const struct unrefract_view *view, double r0, double r1)
{
	for (int r = 0; r < RINGS; r++)
		for (int a = 0; a < ANGLES; a++) {
			double radius = r0 + (r1 - r0) * (r + 0.5) / RINGS, phi = 2 * M_PI * a / ANGLES;
			double p[2] = { radius * cos(phi), radius * sin(phi) };
			out->weight[r][a] = survey_at(&view->survey, view->survey.weight, p);
			out->value[r][a] = survey_at(&view->survey, view->survey.detail, p);
		}
}

struct score {
	double correlation, overlap;
};

static struct score correlate(const struct profile *fixed, const struct profile *turned, int shift)
{
	double ab = 0, aa = 0, bb = 0, w = 0;
	for (int r = 0; r < RINGS; r++)
		for (int a = 0; a < ANGLES; a++) {
			int b = (a + shift + ANGLES) % ANGLES;
			float both = fixed->weight[r][a] * turned->weight[r][b];
			ab += both * fixed->value[r][a] * turned->value[r][b];
			aa += both * fixed->value[r][a] * fixed->value[r][a];
			bb += both * turned->value[r][b] * turned->value[r][b];
			w += both;
		}
	return (struct score){ aa > 0 && bb > 0 ? ab / sqrt(aa * bb) : 0, w / (RINGS * ANGLES) };
}

/* The turn about the axis with the highest correlation of the rings. */
static double find_turn(const struct unrefract_view *fixed, const struct unrefract_view *view, double max_deg)
{
	double r0 = 1.1 * fmax(fixed->pupil.r, view->pupil.r), r1 = 0.93 * fixed->survey.extent;
	struct profile *p = mem_array(2, sizeof *p);
	take_profile(&p[0], fixed, r0, r1);
	take_profile(&p[1], view, r0, r1);
	int best = 0, reach = (int)(max_deg * ANGLES / 360);
	double high = -2;
	for (int shift = -reach; shift <= reach; shift++) {
		double c = correlate(&p[0], &p[1], shift).correlation;
		if (c > high) {
			high = c;
			best = shift;
		}
	}
	free(p);
	return 2 * M_PI * best / ANGLES;
}

/* Normal equations of one Gauss-Newton step for the six parameters of a. */
struct normal {
	double h[6][6], g[6];
};

static void add_point(struct normal *eq, const struct unrefract_view *fixed, const struct unrefract_view *view,
                      const float *from, const float *to, double x, double y)
{
	const double step = 2 * view->survey.extent / view->survey.size;
	double at[2] = { x, y }, p[2];
	affine_apply(p, view->iris.a, x, y);
	double w = survey_at(&fixed->survey, fixed->survey.weight, at) * survey_at(&view->survey, view->survey.weight, p);
	if (w < 0.3)
		return;
	double px[2] = { p[0] + step, p[1] }, py[2] = { p[0], p[1] + step };
	double mx[2] = { p[0] - step, p[1] }, my[2] = { p[0], p[1] - step };
	double gx = (survey_at(&view->survey, to, px) - survey_at(&view->survey, to, mx)) / (2 * step);
	double gy = (survey_at(&view->survey, to, py) - survey_at(&view->survey, to, my)) / (2 * step);
	double residual = survey_at(&fixed->survey, from, at) - survey_at(&view->survey, to, p);
	w /= 1 + residual * residual;  // a glint that only one photograph has pulls little
	double j[6] = { gx * x, gx * y, gx, gy * x, gy * y, gy };
	for (int i = 0; i < 6; i++) {
		for (int k = 0; k < 6; k++)
			eq->h[i][k] += w * j[i] * j[k];
		eq->g[i] += w * j[i] * residual;
	}
}

/* Gauss-Newton on the six parameters: what remains of the turn, and the stretch and shift that errors of the pose cause.
 * Blurred first, so that fibres a few texels apart overlap. */
static void refine(const struct unrefract_view *fixed, struct unrefract_view *view)
{
	static const double sigmas[] = { 3, 1.2 };
	const struct unrefract_survey *s = &fixed->survey;
	size_t n = (size_t)s->size * (size_t)s->size;
	float *from = mem_array(n, sizeof *from), *to = mem_array(n, sizeof *to);
	for (int level = 0; level < COUNT(sigmas); level++) {
		memcpy(from, fixed->survey.detail, n * sizeof *from);
		memcpy(to, view->survey.detail, n * sizeof *to);
		plane_blur_weighted(from, fixed->survey.weight, s->size, s->size, sigmas[level], 0);
		plane_blur_weighted(to, view->survey.weight, s->size, s->size, sigmas[level], 0);
		for (int iter = 0; iter < 8; iter++) {
			struct normal eq = { 0 };
			double mm = 2 * s->extent / s->size;
			for (int row = 0; row < s->size; row += 2)
				for (int col = 0; col < s->size; col += 2)
					add_point(&eq, fixed, view, from, to, (col + 0.5) * mm - s->extent, (row + 0.5) * mm - s->extent);
			if (!chol_solve(6, 6, &eq.h[0][0], eq.g))
				break;
			for (int i = 0; i < 6; i++)
				view->iris.a[i / 3][i % 3] += eq.g[i];
		}
	}
	free(from);
	free(to);
}

/* Correlation and overlap of the two as registered. */
static struct score agreement(const struct unrefract_view *fixed, const struct unrefract_view *view)
{
	const struct unrefract_survey *s = &fixed->survey;
	double ab = 0, aa = 0, bb = 0, w = 0, all = 0, mm = 2 * s->extent / s->size;
	for (int row = 0; row < s->size; row += 2)
		for (int col = 0; col < s->size; col += 2) {
			double at[2] = { (col + 0.5) * mm - s->extent, (row + 0.5) * mm - s->extent }, p[2];
			affine_apply(p, view->iris.a, at[0], at[1]);
			double wf = survey_at(s, s->weight, at), a = survey_at(s, s->detail, at);
			double both = wf * survey_at(&view->survey, view->survey.weight, p);
			double b = survey_at(&view->survey, view->survey.detail, p);
			ab += both * a * b, aa += both * a * a, bb += both * b * b;
			w += both, all += wf;
		}
	return (struct score){ aa > 0 && bb > 0 ? ab / sqrt(aa * bb) : 0, all > 0 ? w / all : 0 };
}

void unrefract_register(const struct unrefract_view *fixed, struct unrefract_view *view,
                        const struct unrefract_conf *conf)
{
	double turn = find_turn(fixed, view, conf->torsion_max_deg), c = cos(turn), s = sin(turn);
	double(*a)[3] = view->iris.a;
	a[0][0] = a[1][1] = c;
	a[0][1] = -s;
	a[1][0] = s;
	a[0][2] = a[1][2] = 0;
	refine(fixed, view);
	view->rotation = atan2(a[1][0] - a[0][1], a[0][0] + a[1][1]);
	struct score score = agreement(fixed, view);
	view->correlation = score.correlation;
	double stretch = sqrt(fabs(a[0][0] * a[1][1] - a[0][1] * a[1][0]));
	view->used = score.overlap * 100 > SMALLEST_OVERLAP && score.correlation >= conf->correlation_min
	             && fabs(stretch - 1) < 0.1 && hypot(a[0][2], a[1][2]) < 0.15 * fixed->survey.extent;
}
