#include "track/clip/steady.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/walk.h"

enum { MOTIONS = 6, LEAST_POINTS = 20 };

/* A head is on a rest when it returns to within rest_px of the reference in rest_share of the frames of each third of the clip.
 * In rendered films of heads on a rest 0.3 to 0.5 of the frames do, of heads held freely none after the first second. */
static const double rest_px = 0.3, rest_share = 0.1;

/* Least motion assumed from frame to frame: degrees, mm. */
static const double least_turn = 0.01, least_shift = 0.01;

/* Skin is followed so far about its middle: what moves there by so much turns the head by the quotient. Frames of an expression err alike: so many in a
 * row count as one, here as its root. */
static const double lever_mm = 40, alike = 5;

/* Distance of a frame's skin from the reference frame's: 10 % quantile over the points, px. */
static double away(const struct track_result *r, long reference, long frame, double *room)
{
	int n = 0;
	for (int i = 0; i < r->n_points; i++) {
		long at = frame * r->n_points + i, was = reference * r->n_points + i;
		if (r->confidence[at] > 0.5f)
			room[n++] = hypot((double)(r->skin[at][0] - r->skin[was][0]), (double)(r->skin[at][1] - r->skin[was][1]));
	}
	return n > r->n_points / 4 ? stats_quantile(n, room, 0.1) : INFINITY;
}

/* True for a head on a rest: it returns to the same place in every third of the clip. Skin alone cannot distinguish raised
 * cheeks from a head that comes nearer. */
static bool rests(const struct track_result *r, long reference)
{
	enum { PARTS = 3 };
	double *room = mem_array((size_t)r->n_points + 1, sizeof *room);
	bool yes = r->n_points > 0 && r->n >= 10L * PARTS;
	for (int part = 0; part < PARTS && yes; part++) {
		long back = 0, from = part * r->n / PARTS, to = (part + 1) * r->n / PARTS;
		for (long i = from; i < to; i++)
			back += away(r, reference, i, room) < rest_px;
		yes = (double)back >= rest_share * (double)(to - from);
	}
	free(room);
	return yes;
}

/* Recomputes the skin in the modelling camera with the final poses. */
static void model_again(struct track_result *r, const struct track_points *points, const struct track_clip *clip)
{
#pragma omp parallel for schedule(static)
	for (long f = 0; f < r->n; f++) {
		for (int i = 0; i < r->n_points; i++) {
			const float *at = r->skin[f * r->n_points + i];
			const double px[2] = { (double)at[0], (double)at[1] };
			track_to_model(r->skin_model[f * r->n_points + i], px, points->head[i], r->pose[f], clip);
		}
	}
}

/* Median residual of a frame's skin, lids excepted, against the rigid head, px; INFINITY with too few points. */
static double misfit(const struct track_result *r, long frame, const struct track_points *points, const bool *lid, const struct track_clip *clip, double *room)
{
	int n = 0;
	for (int i = 0; i < r->n_points; i++) {
		long at = frame * r->n_points + i;
		double px[2];
		if (!lid[i] && r->confidence[at] > 0 && head_project(px, &clip->camera, r->pose[frame], points->head[i]))
			room[n++] = hypot((double)r->skin[at][0] - px[0], (double)r->skin[at][1] - px[1]);
	}
	return n >= LEAST_POINTS ? stats_median(n, room) : INFINITY;
}

/* Smooths each of the six parameters of the motion since the reference over the clip, as a random walk. A frame whose skin
 * misfits the head k times the
 * median has k times the standard deviation: a raised brow pulls nose and cheek along. */
static void smooth(struct track_result *r, const double *misfit, double usual, const double pivot[3], const struct track_clip *clip)
{
	size_t n = (size_t)r->n;
	double *x = mem_array(MOTIONS * n, sizeof *x), *sigma = mem_array(n, sizeof *sigma), *room = mem_array(n, sizeof *room);
	for (long f = 0; f < r->n; f++) {
		double d[MOTIONS];
		head_motion(d, r->pose[f], clip->cam_from_head, pivot);
		for (int k = 0; k < MOTIONS; k++)
			x[(size_t)k * n + (size_t)f] = d[k];
	}
	for (int k = 0; k < MOTIONS; k++) {
		double *own = x + (size_t)k * n, step;
		for (size_t f = 0; f + 1 < n; f++)
			room[f] = fabs(own[f + 1] - own[f]);
		step = fmax(k < 3 ? least_turn * M_PI / 180 : least_shift, stats_median((int)n - 1, room));
		for (size_t f = 0; f < n; f++)
			sigma[f] = step * fmin(1e4, fmax(1, misfit[f] / usual));
		walk_smooth(r->n, own, sigma, step, room);
	}
	for (long f = 0; f < r->n; f++) {
		double d[MOTIONS];
		for (int k = 0; k < MOTIONS; k++)
			d[k] = x[(size_t)k * n + (size_t)f];
		head_moved(r->pose[f], clip->cam_from_head, d, pivot);
	}
	free(x);
	free(sigma);
	free(room);
}

/* What skin that moves by so much (px) about the head does to the pose: error of one of the six parameters of motion, radians, mm. */
static double mislead(double px, int parameter, const double pivot[3], const struct track_clip *clip)
{
	const double mm = px * pivot[2] / clip->camera.focal_px;
	return parameter < 3 ? mm / lever_mm : parameter < 5 ? mm : mm * pivot[2] / lever_mm;
}

/* A head that moves goes on as it did where its skin tells no pose: a squint moves all the skin round the eyes, and with it the pose. Frames whose skin
 * misfits the rigid head by more than twice what is usual weigh the less. */
static void glide(struct track_result *r, double usual, const double pivot[3], const struct track_clip *clip)
{
	size_t n = (size_t)r->n;
	double *x = mem_array(MOTIONS * n, sizeof *x), *sigma = mem_array(n, sizeof *sigma), *room = mem_array(2 * n, sizeof *room);
	for (long f = 0; f < r->n; f++) {
		double d[MOTIONS];
		head_motion(d, r->pose[f], clip->cam_from_head, pivot);
		for (int k = 0; k < MOTIONS; k++)
			x[(size_t)k * n + (size_t)f] = d[k];
	}
	for (int k = 0; k < MOTIONS; k++) {
		const double least = k < 3 ? least_turn * M_PI / 180 : least_shift;
		double *own = x + (size_t)k * n, noise, bend;
		walk_unrest(&noise, &bend, r->n, own, room);
		for (size_t f = 0; f < n; f++)
			sigma[f] = hypot(fmax(least, noise), alike * mislead(fmin(1e4, sqrt(fmax(0, pow(r->misfit[f], 2) - pow(2 * usual, 2)))), k, pivot, clip));
		walk_glide(r->n, own, sigma, fmax(least, bend), room);
	}
	for (long f = 0; f < r->n; f++) {
		double d[MOTIONS];
		for (int k = 0; k < MOTIONS; k++)
			d[k] = x[(size_t)k * n + (size_t)f];
		head_moved(r->pose[f], clip->cam_from_head, d, pivot);
	}
	free(x);
	free(sigma);
	free(room);
}

/* Fills r->misfit. */
static void misfits(struct track_result *r, const struct track_points *points, const struct track_subject *s, const struct track_clip *clip)
{
	bool *lid = mem_new((size_t)points->n + 1, sizeof *lid);
	double *room = mem_array((size_t)points->n + 1, sizeof *room);
	r->misfit = mem_array((size_t)r->n + 1, sizeof *r->misfit);
	for (int i = 0; i < points->n; i++)
		lid[i] = track_on_lid(points->head[i], s);
	for (long f = 0; f < r->n; f++)
		r->misfit[f] = r->lost_at[f] ? INFINITY : misfit(r, f, points, lid, clip, room);
	free(lid);
	free(room);
}

/* Frames whose skin misfits by more than that are unsure, and those beside them: lids are followed from frame to frame, and come back late. */
static void doubt(struct track_result *r, double most_px)
{
	const double back_s = 0.08;
	r->unsure_at = mem_new((size_t)r->n + 1, sizeof *r->unsure_at);
	for (long f = 0; f < r->n; f++) {
		if (r->lost_at[f] || !(r->misfit[f] > most_px))
			continue;
		for (long k = f; k >= 0 && r->time[f] - r->time[k] < back_s; k--)
			r->unsure_at[k] = true;
		for (long k = f; k < r->n && r->time[k] - r->time[f] < back_s; k++)
			r->unsure_at[k] = true;
	}
	for (long f = 0; f < r->n; f++)
		r->unsure += r->unsure_at[f];
}

static void follow_path(struct track_result *r, const struct track_points *points, const struct track_clip *clip, double stirs_mm)
{
	double *room = mem_array((size_t)r->n + 1, sizeof *room), pivot[3] = { 0 };
	for (int i = 0; i < points->n; i++) {
		double p[3];
		head_from(p, clip->cam_from_head, points->head[i]);
		for (int k = 0; k < 3; k++)
			pivot[k] += p[k] / points->n;
	}
	memcpy(room, r->misfit, (size_t)r->n * sizeof *room);
	double usual = stats_median((int)r->n, room);
	if (isfinite(usual) && usual > 0 && clip->moves.turned > 0) {
		glide(r, usual, pivot, clip);
		doubt(r, stirs_mm * clip->camera.focal_px / pivot[2]);
	}
	if (isfinite(usual) && usual > 0 && !(clip->moves.turned > 0))
		smooth(r, r->misfit, usual, pivot, clip);
	free(room);
}

void track_steady(struct track_result *r, long reference, const struct track_points *points, const struct track_subject *s, const struct track_clip *clip, double stirs_mm)
{
	r->rests = rests(r, reference);
	misfits(r, points, s, clip);
	if (r->rests) {
		for (long f = 0; f < r->n; f++)
			memcpy(r->pose[f], clip->cam_from_head, sizeof r->pose[f]);
	} else if (r->n > 3) {
		follow_path(r, points, clip, stirs_mm);
	}
	model_again(r, points, clip);
}
