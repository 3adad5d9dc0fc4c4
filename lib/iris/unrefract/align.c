#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "iris/unrefract/register.h"

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* Colour gain: the median ratio of the colours where both views see the iris well. */
static void take_gain(const struct unrefract_view *fixed, struct unrefract_view *view)
{
	const struct unrefract_survey *s = &fixed->survey;
	double mm = 2 * s->extent / s->size, to = view->survey.size / (2 * view->survey.extent);
	float *ratio = mem_array((size_t)s->size * (size_t)s->size / 9 + 3 * (size_t)s->size, sizeof *ratio);
	for (int c = 0; c < 3; c++) {
		int n = 0;
		for (int row = 1; row < s->size; row += 3)
			for (int col = 1; col < s->size; col += 3) {
				double x = (col + 0.5) * mm - s->extent, y = (row + 0.5) * mm - s->extent, p[2];
				long i = (long)row * s->size + col;
				affine_apply(p, view->iris.a, x, y);
				if (s->weight[i] < 0.9f || survey_at(&view->survey, view->survey.weight, p) < 0.9f)
					continue;
				int cx = (int)((p[0] + s->extent) * to), cy = (int)((p[1] + s->extent) * to);
				float a = s->rgb[3 * i + c], b = view->survey.rgb[3 * ((long)cy * s->size + cx) + c];
				if (a > 1e-3f && b > 1e-3f)
					ratio[n++] = a / b;
			}
		qsort(ratio, (size_t)n, sizeof *ratio, by_value);
		view->gain[c] = n > 100 ? ratio[n / 2] : 1;
	}
	free(ratio);
}

/* Log of the brightness after the gain, blurred over 0.06 mm. */
static float *brightness(const struct unrefract_view *view)
{
	const struct unrefract_survey *s = &view->survey;
	size_t n = (size_t)s->size * (size_t)s->size;
	float *out = mem_array(n, sizeof *out);
	for (size_t i = 0; i < n; i++)
		out[i] = view->gain[0] * s->rgb[3 * i] + view->gain[1] * s->rgb[3 * i + 1] + view->gain[2] * s->rgb[3 * i + 2];
	plane_blur_weighted(out, s->weight, s->size, s->size, 0.06 * s->size / (2 * s->extent), 0);
	for (size_t i = 0; i < n; i++)
		out[i] = logf(out[i] + 1e-3f);
	return out;
}

static void affine_invert(double out[2][3], const double a[2][3])
{
	double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
	out[0][0] = a[1][1] / det, out[0][1] = -a[0][1] / det;
	out[1][0] = -a[1][0] / det, out[1][1] = a[0][0] / det;
	out[0][2] = -(out[0][0] * a[0][2] + out[0][1] * a[1][2]);
	out[1][2] = -(out[1][0] * a[0][2] + out[1][1] * a[1][2]);
}

/* Factor on view k's weight at its own point p, from the darkest and the sharpest of the other views there. */
static float against_others(int n, const struct unrefract_view views[], float *const bright[], int k,
                            const double back[2][3], const double p[2], float own_bright, float own_sharp)
{
	double q[2], other[2];
	affine_apply(q, back, p[0], p[1]);
	float low = INFINITY, sharp = 0;
	for (int j = 0; j < n; j++) {
		if (j == k || !views[j].used)
			continue;
		affine_apply(other, views[j].iris.a, q[0], q[1]);
		const struct unrefract_survey *s = &views[j].survey;
		if (survey_at(s, s->weight, other) < 0.6f)
			continue;
		low = fminf(low, survey_at(s, bright[j], other));
		sharp = fmaxf(sharp, survey_at(s, s->sharp, other));
	}
	const float glint = 0.35f;  // log: 40 % brighter than another photograph shows it
	float factor = own_bright - low > glint ? 0.02f : 1;
	return sharp > own_sharp ? factor * fmaxf(own_sharp / sharp, 0.05f) : factor;
}

/* Estimates colour gains, and lowers weights where a view is brighter than the others (a reflection that its own mask
 * missed) or less sharp. */
static void agree(int n, struct unrefract_view views[], int fixed)
{
	float **bright = mem_new((size_t)n, sizeof *bright), **weight = mem_new((size_t)n, sizeof *weight);
	for (int k = 0; k < n; k++) {
		if (!views[k].used)
			continue;
		if (k != fixed)
			take_gain(&views[fixed], &views[k]);
		bright[k] = brightness(&views[k]);
	}
	for (int k = 0; k < n; k++) {
		if (!views[k].used)
			continue;
		const struct unrefract_survey *s = &views[k].survey;
		weight[k] = mem_array((size_t)s->size * (size_t)s->size, sizeof(float));
		double back[2][3], mm = 2 * s->extent / s->size;
		affine_invert(back, views[k].iris.a);
#pragma omp parallel for schedule(dynamic, 4)
		for (int row = 0; row < s->size; row++)
			for (int col = 0; col < s->size; col++) {
				long i = (long)row * s->size + col;
				double p[2] = { (col + 0.5) * mm - s->extent, (row + 0.5) * mm - s->extent };
				weight[k][i] = s->weight[i] > 0 ? s->weight[i] * against_others(n, views, bright, k, back, p, bright[k][i],
				                                                                s->sharp[i])
				                                : 0;
			}
	}
	for (int k = 0; k < n; k++) {
		if (views[k].used) {
			free(views[k].survey.weight);
			views[k].survey.weight = weight[k];
		}
		free(bright[k]);
	}
	free(bright);
	free(weight);
}

/* How much iris a view shows, and how finely. */
static double worth(const struct unrefract_view *view)
{
	double sum = 0;
	for (long i = 0; i < (long)view->survey.size * view->survey.size; i++)
		sum += view->survey.weight[i];
	return view->used ? sum * fmin(iris_view_px_per_mm(&view->iris), 200) * cos(view->fit->theta) : -1;
}

/* A grey photograph would take the colour from what it shows best. */
static void leave_out_grey(int n, struct unrefract_view views[])
{
	bool colour = false;
	for (int i = 0; i < n; i++)
		colour |= views[i].used && !views[i].grey;
	for (int i = 0; i < n && colour; i++)
		if (views[i].used && views[i].grey) {
			views[i].used = false;
			snprintf(views[i].note, sizeof views[i].note, "is grey, and others of this eye have colour");
		}
}

int unrefract_align(int n, struct unrefract_view views[], const struct unrefract_conf *conf)
{
	leave_out_grey(n, views);
	int fixed = 0;
	for (int i = 1; i < n; i++)
		fixed = worth(&views[i]) > worth(&views[fixed]) ? i : fixed;
	views[fixed].correlation = 1;
	int used = 0;
	for (int i = 0; i < n; i++)
		used += views[i].used;
	for (int i = 0; i < n && used > 1; i++)
		if (views[i].used)
			unrefract_detail(&views[i].survey);
	used = 1;
	for (int i = 0; i < n; i++) {
		if (i == fixed || !views[i].used)
			continue;
		unrefract_register(&views[fixed], &views[i], conf);
		used += views[i].used;
		if (!views[i].used)
			snprintf(views[i].note, sizeof views[i].note, "does not match %.60s (correlation %.2f)", views[fixed].name,
			         views[i].correlation);
	}
	if (used > 1)
		agree(n, views, fixed);
	return fixed;
}
