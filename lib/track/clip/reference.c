#include "track/clip/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"

enum { LEAST_FRAMES = 8 };

static const double open_enough = 0.8;   // openness of an open eye
/* degrees: beyond this distance from the median gaze the lids have moved by more than their measurement error; a better frame
 * must be so much nearer. */
static const double off_most = 4, nearer = 2;
/* Penalties in degrees: of a shut eye; of the last frame against the first (tracking starts at the first, where a moving head
 * lies elsewhere). */
static const double half_shut = 20, late = 10;
/* Penalty in degrees of a frame whose skin misfits the rigid head twice as much as the median (an expression), and its maximum. */
static const double stirred = 4, stirred_most = 20;
/* Upside down where the lower lid moves so many times as much as the upper: in truth it moves by half or less of it. */
static const double turned = 1.5;

static bool is_open(const struct eye_state *s)
{
	return s->blink == BLINK_OPEN && s->openness > open_enough && isfinite(s->gaze[0]) && isfinite(s->gaze[1]);
}

/* Spread of the middle of a margin along the head's y axis over all frames that have it, px. */
static double spread(const struct track_result *r, const struct track_clip *clip, const struct track_subject *s, int side, int lid)
{
	double *y = mem_array((size_t)r->n + 1, sizeof *y);
	const double(*m)[4] = clip->cam_from_head;
	int n = 0;
	for (long f = 0; f < r->n; f++) {
		const struct eye_state *t = &r->eyes.state[f][side];
		const double *p = t->lid[lid][t->lid_points / 2];
		float at[2];
		if (r->lost_at[f] || t->lid_points < 1 || !isfinite(p[0]))
			continue;
		track_to_model(at, p, s->opening[side].center, r->pose[f], clip);
		y[n++] = (double)at[0] * m[0][1] + (double)at[1] * m[1][1];
	}
	double d = n < LEAST_FRAMES ? NAN : stats_quantile(n, y, 0.95) - stats_quantile(n, y, 0.05);
	free(y);
	return d;
}

bool reference_is_overturned(const struct track_result *r, const struct track_clip *clip, const struct track_subject *s)
{
	double upper = 0, lower = 0;
	for (int e = 0; e < SIDES; e++) {
		double u = s->opening[e].open ? spread(r, clip, s, e, LID_UPPER) : NAN, l = s->opening[e].open ? spread(r, clip, s, e, LID_LOWER) : NAN;
		if (isfinite(u) && isfinite(l)) {
			upper += u;
			lower += l;
		}
	}
	return lower > turned * upper;
}

double reference_usual_height(const struct track_result *r, int side)
{
	double *v = mem_array((size_t)r->n + 1, sizeof *v);
	int n = 0;
	for (long f = 0; f < r->n; f++)
		if (!r->lost_at[f] && is_open(&r->eyes.state[f][side]))
			v[n++] = r->eyes.state[f][side].gaze[1];
	double usual = n ? stats_median(n, v) : NAN;
	free(v);
	return usual;
}

/* Mean gaze of the eyes that are seen, degrees; wide: openness of the less open one. Returns false when one of them is not
 * open. */
static bool gaze_of(double gaze[2], double *wide, const struct track_result *r, long f)
{
	int n = 0;
	gaze[0] = gaze[1] = 0;
	*wide = 1;
	for (int e = 0; e < SIDES; e++) {
		const struct eye_state *s = &r->eyes.state[f][e];
		if (!r->eyes.globe[e].seen)
			continue;
		if (r->lost_at[f] || !is_open(s))
			return false;
		for (int k = 0; k < 2; k++)
			gaze[k] += s->gaze[k] * 180 / M_PI;
		*wide = fmin(*wide, s->openness);
		n++;
	}
	for (int k = 0; k < 2 && n; k++)
		gaze[k] /= n;
	return n > 0;
}

double reference_usual_misfit(const struct track_result *r)
{
	double *room = mem_array((size_t)r->n + 1, sizeof *room), usual = 0;
	if (r->misfit) {
		memcpy(room, r->misfit, (size_t)r->n * sizeof *room);
		usual = fmax(stats_median((int)r->n, room), 1e-3);
	}
	free(room);
	return usual;
}

struct reference_view reference_judge(const struct track_result *r, const struct track_clip *clip, long every)
{
	struct reference_view view = { .aside = NAN, .up = NAN, .better = -1 };
	size_t room = (size_t)r->n + 1;
	double(*gaze)[2] = mem_array(room, sizeof *gaze), *x = mem_array(room, sizeof *x), *wide = mem_array(room, sizeof *wide), *cost = mem_array(room, sizeof *cost), usual[2];
	bool *open = mem_new(room, sizeof *open);
	long here = clip->reference / every, best = 0;
	int n = 0;
	const double calm = reference_usual_misfit(r);
	for (long f = 0; f < r->n; f++)
		n += open[f] = gaze_of(gaze[f], &wide[f], r, f);
	for (int k = 0; k < 2; k++) {
		int m = 0;
		for (long f = 0; f < r->n; f++)
			if (open[f])
				x[m++] = gaze[f][k];
		usual[k] = m ? stats_median(m, x) : NAN;
	}
	for (long f = 0; f < r->n && n >= LEAST_FRAMES; f++) {
		// motion blur in a saccade; moving lids before and after a blink
		double off = open[f] ? hypot(gaze[f][0] - usual[0], gaze[f][1] - usual[1]) + half_shut * (1 - wide[f]) : INFINITY, moves = INFINITY;
		for (long g = f - 1; g <= f + 1; g += 2)
			if (g >= 0 && g < r->n) {
				moves = open[g] ? fmin(moves, hypot(gaze[f][0] - gaze[g][0], gaze[f][1] - gaze[g][1])) : moves;
				off += open[g] ? 0 : off_most;
			}
		off += calm > 0 ? fmin(stirred_most, stirred * fmax(0, r->misfit[f] / calm - 1)) : 0;
		cost[f] = off + 0.25 * fmin(moves, 20) + late * (double)f / (double)r->n;
		best = cost[f] < cost[best] ? f : best;
	}
	if (here < r->n && n >= LEAST_FRAMES) {
		view.open = open[here];
		view.aside = open[here] ? gaze[here][0] - usual[0] : NAN;
		view.up = open[here] ? gaze[here][1] - usual[1] : NAN;
		if (!(open[here] && hypot(view.aside, view.up) <= off_most) && cost[best] < cost[here] - nearer)
			view.better = best * every + clip->reference % every;
	}
	free(gaze);
	free(x);
	free(cost);
	free(wide);
	free(open);
	return view;
}
