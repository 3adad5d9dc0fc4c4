#include "track/gaze/seek.h"

#include <math.h>

enum { ARCS = 32, LEAST = 10 };
// The eye turns no further than this in the head, radians (Guitton and Volle 1987: 55 degrees).
static const double TURN_MAX = 0.95;

static double luma_near(const struct luma *luma, double x, double y)
{
	int i = (int)floor(x), j = (int)floor(y);
	i = i < 0 ? 0 : i >= luma->width ? luma->width - 1 : i;
	j = j < 0 ? 0 : j >= luma->height ? luma->height - 1 : j;
	return luma->px[(long)j * luma->stride + i];
}

/* The score of one direction. */
static double score_of(const struct gaze_sight *sight, const double fick[2])
{
	const struct luma *luma = sight->luma;
	const struct gaze_globe *globe = sight->globe;
	double at[3][2], plane = gaze_plane(globe), r = globe->limbus;
	double eye[3][3] = { { 0, 0, plane }, { r, 0, plane }, { 0, r, plane } };
	for (int k = 0; k < 3; k++)
		if (!gaze_pixel(at[k], globe, sight->view, (double[3]){ fick[0], fick[1], 0 }, eye[k]))
			return NAN;
	if (!(at[0][0] > 0 && at[0][1] > 0 && at[0][0] < luma->width && at[0][1] < luma->height))
		return NAN;
	// Near the circle its projection is close to affine.
	double ax = at[1][0] - at[0][0], ay = at[1][1] - at[0][1], bx = at[2][0] - at[0][0], by = at[2][1] - at[0][1];
	static const double tap[4] = { 0.80, 0.90, 1.10, 1.20 }, pupil[2] = { 0.18, 0.65 };
	double sum = 0, dark = 0;
	int n = 0, m = 0;
	for (int i = 0; i < ARCS; i++) {
		double c = cos(2 * M_PI * (i + 0.5) / ARCS), s = sin(2 * M_PI * (i + 0.5) / ARCS), v[4];
		double ux = c * ax + s * bx, uy = c * ay + s * by;
		// A pupil darker than the iris helps where little of the limbus is visible.
		double in[2] = { at[0][0] + pupil[1] * ux, at[0][1] + pupil[1] * uy };
		if (!sight->seen || sight->seen(sight->ctx, in)) {
			double rise = (luma_near(luma, in[0], in[1])
			               - luma_near(luma, at[0][0] + pupil[0] * ux, at[0][1] + pupil[0] * uy)) / sight->contrast;
			dark += rise > 0.5 ? 0.5 : rise < -0.25 ? -0.25 : rise;
			m++;
		}
		if (sight->seen && !sight->seen(sight->ctx, (double[2]){ at[0][0] + ux, at[0][1] + uy }))
			continue;
		n++;
		for (int k = 0; k < 4; k++)
			v[k] = luma_near(luma, at[0][0] + tap[k] * ux, at[0][1] + tap[k] * uy);
		double rise = (0.5 * (v[2] + v[3]) - 0.5 * (v[0] + v[1])) / sight->contrast;
		// Clamped: reflections and lids contradict in places.
		sum += rise > 1 ? 1 : rise < -0.5 ? -0.5 : rise;
	}
	// Few arcs count less.
	return sum / (n > LEAST ? n : LEAST) + 0.5 * dark / (m > LEAST ? m : LEAST);
}

static double try_around(double best[2], double score, double step, int reach, const struct gaze_sight *sight)
{
	double from[2] = { best[0], best[1] };
	for (int i = -reach; i <= reach; i++) {
		for (int j = -reach; j <= reach; j++) {
			double fick[2] = { from[0] + i * step, from[1] + j * step };
			if ((i == 0 && j == 0) || hypot(fick[0], fick[1]) > TURN_MAX)
				continue;
			double s = score_of(sight, fick);
			if (s > score || isnan(score)) {
				score = s;
				best[0] = fick[0];
				best[1] = fick[1];
			}
		}
	}
	return score;
}

double gaze_seek(double fick[2], const struct gaze_sight *sight, double reach, double step, double fine)
{
	double score = score_of(sight, fick);
	score = try_around(fick, score, step, (int)ceil(reach / step), sight);
	for (double h = step / 2; h > fine / 2; h /= 2)
		score = try_around(fick, score, h, 1, sight);
	return score;
}
