#include "track/gaze/seek.h"

#include <math.h>

#include "base/mem.h"

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

/* The limbus of one direction: its middle, and where its axes end from there; near the circle its projection is close to affine. px */
struct disc { double x, y, ax, ay, bx, by; };

static bool disc_of(struct disc *d, const struct gaze_sight *sight, const double fick[2])
{
	const struct gaze_globe *globe = sight->globe;
	double at[3][2], plane = gaze_plane(globe), r = globe->limbus;
	double eye[3][3] = { { 0, 0, plane }, { r, 0, plane }, { 0, r, plane } };
	double R[3][3];
	gaze_rotation(R, (double[3]){ fick[0], fick[1], 0 });
	for (int k = 0; k < 3; k++)
		if (!gaze_pixel_of(at[k], globe, sight->view, R, eye[k]))
			return false;
	*d = (struct disc){ at[0][0], at[0][1], at[1][0] - at[0][0], at[1][1] - at[0][1], at[2][0] - at[0][0], at[2][1] - at[0][1] };
	return d->x > 0 && d->y > 0 && d->x < sight->luma->width && d->y < sight->luma->height;
}

/* By the evidence: iris, pupil and what they mirror inside of the limbus, sclera outside. Skin and lashes say nothing. */
static double score_told(const struct evidence *e, const struct disc *d)
{
	static const struct { double r; int n; double sign; } ring[] = { { 0.25, 4, 1 }, { 0.5, 8, 1 }, { 0.75, 12, 1 }, { 0.92, 16, 1 }, { 1.1, 16, -1 }, { 1.3, 16, -1 } };
	const double least = 16;  // so many places; of fewer each counts no more
	double sum = 0, eye = 0;
	for (int k = 0; k < COUNT(ring); k++)
		for (int i = 0; i < ring[k].n; i++) {
			const double t = 2 * M_PI * (i + 0.5) / ring[k].n, c = ring[k].r * cos(t), s = ring[k].r * sin(t);
			const double x = d->x + c * d->ax + s * d->bx, y = d->y + c * d->ay + s * d->by;
			const double white = (double)evidence_at(e, EVIDENCE_SCLERA, x, y);
			const double iris = (double)(evidence_at(e, EVIDENCE_IRIS, x, y) + evidence_at(e, EVIDENCE_PUPIL, x, y));
			sum += ring[k].sign * (iris - white);
			eye += iris + white;
		}
	return sum / fmax(eye, least);
}

/* Directions of the arcs. */
struct arcs {
	double cos[ARCS], sin[ARCS];
};

/* The score of one direction. */
static double score_of(const struct gaze_sight *sight, const struct arcs *arcs, const double fick[2])
{
	const struct luma *luma = sight->luma;
	struct disc d;
	if (!disc_of(&d, sight, fick))
		return NAN;
	if (sight->evidence)
		return score_told(sight->evidence, &d);
	static const double tap[4] = { 0.80, 0.90, 1.10, 1.20 }, pupil[2] = { 0.18, 0.65 };
	double sum = 0, dark = 0;
	int n = 0, m = 0;
	for (int i = 0; i < ARCS; i++) {
		double c = arcs->cos[i], s = arcs->sin[i], v[4];
		double ux = c * d.ax + s * d.bx, uy = c * d.ay + s * d.by;
		// A pupil darker than the iris helps where little of the limbus is visible.
		double in[2] = { d.x + pupil[1] * ux, d.y + pupil[1] * uy };
		if (!sight->seen || sight->seen(sight->ctx, in)) {
			double rise = (luma_near(luma, in[0], in[1])
			               - luma_near(luma, d.x + pupil[0] * ux, d.y + pupil[0] * uy)) / sight->contrast;
			dark += rise > 0.5 ? 0.5 : rise < -0.25 ? -0.25 : rise;
			m++;
		}
		if (sight->seen && !sight->seen(sight->ctx, (double[2]){ d.x + ux, d.y + uy }))
			continue;
		n++;
		for (int k = 0; k < 4; k++)
			v[k] = luma_near(luma, d.x + tap[k] * ux, d.y + tap[k] * uy);
		double rise = (0.5 * (v[2] + v[3]) - 0.5 * (v[0] + v[1])) / sight->contrast;
		// Clamped: reflections and lids contradict in places.
		sum += rise > 1 ? 1 : rise < -0.5 ? -0.5 : rise;
	}
	// Few arcs count less.
	return sum / (n > LEAST ? n : LEAST) + 0.5 * dark / (m > LEAST ? m : LEAST);
}

static double try_around(double best[2], double score, double step, int reach, const struct gaze_sight *sight, const struct arcs *arcs)
{
	double from[2] = { best[0], best[1] };
	for (int i = -reach; i <= reach; i++) {
		for (int j = -reach; j <= reach; j++) {
			double fick[2] = { from[0] + i * step, from[1] + j * step };
			if ((i == 0 && j == 0) || hypot(fick[0], fick[1]) > TURN_MAX)
				continue;
			double s = score_of(sight, arcs, fick);
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
	struct arcs arcs;
	for (int i = 0; i < ARCS; i++) {
		arcs.cos[i] = cos(2 * M_PI * (i + 0.5) / ARCS);
		arcs.sin[i] = sin(2 * M_PI * (i + 0.5) / ARCS);
	}
	double score = score_of(sight, &arcs, fick);
	score = try_around(fick, score, step, (int)ceil(reach / step), sight, &arcs);
	for (double h = step / 2; h > fine / 2; h /= 2)
		score = try_around(fick, score, h, 1, sight, &arcs);
	return score;
}
