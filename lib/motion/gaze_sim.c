#include "motion/gaze_sim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

enum { HISTORY = 512 };  // ms kept for delays
static const double step_s = 1e-3, jump_speed = 120;  // degrees/s: a faster target has jumped

struct gaze_sim {
	struct gaze_conf conf;
	gaze_source *source;
	void *ctx;
	struct rng rng;
	long now;                       // ms
	struct gaze_input input, last;
	double eye[2], pursuit[2], drift[2], nearness;  // degrees, degrees/s, degrees, 1/mm
	double slip[HISTORY][2];        // input velocity of pursuit, degrees/s, by ms
	double near[HISTORY];
	bool moving, pending, catch_up;
	double begin, origin[2], way[2];  // of the saccade now or next
	struct saccade saccade;
	double rest_until;
	struct gaze_saccade *done;
	int n_done;
	bool started;
};

static double radians(double degrees)
{
	return degrees * (M_PI / 180);
}

static double degrees(double rad)
{
	return rad * (180 / M_PI);
}

static void direction(double out[3], const double angles[2])
{
	double h = radians(angles[0]), v = radians(angles[1]);
	out[0] = sin(h) * cos(v);
	out[1] = sin(v);
	out[2] = cos(h) * cos(v);
}

static void angles_of(double out[2], const double d[3])
{
	out[0] = degrees(atan2(d[0], d[2]));
	out[1] = degrees(atan2(d[1], hypot(d[0], d[2])));
}

double listing_torsion(double horizontal, double vertical)
{
	// R: the smallest rotation from z to the line of sight d. Fick's frame there: Ry(h) Rx(-v); torsion is what is left.
	double d[3], angles[2] = { horizontal, vertical }, h = radians(horizontal), v = radians(vertical);
	direction(d, angles);
	double k = 1 / (1 + d[2]), Rx[3] = { 1 - k * d[0] * d[0], -k * d[0] * d[1], -d[0] };  // R's first column
	double right[3] = { cos(h), 0, -sin(h) }, up[3] = { -sin(h) * sin(v), cos(v), -cos(h) * sin(v) };
	return degrees(atan2(vec_dot(up, Rx), vec_dot(right, Rx)));
}

void gaze_eyes(double eye[2][3], const double cyclopean[2], double distance, double ipd)
{
	double d[3];
	direction(d, cyclopean);
	for (int e = 0; e < 2; e++) {
		// Left eye at x = +ipd / 2: x points to the person's left.
		double p[3] = { d[0] - (isinf(distance) ? 0 : (e ? -1 : 1) * 0.5 * ipd / distance), d[1], d[2] };
		angles_of(eye[e], p);
		eye[e][2] = listing_torsion(eye[e][0], eye[e][1]);
	}
}

/* Direction of the target in the head. */
static void in_head(double out[2], const struct gaze_input *in)
{
	double d[3], h = radians(in->head[0]), v = radians(in->head[1]), p[3], q[3];
	direction(d, in->target);
	// The head's rotation is Ry(h) Rx(-v): inverted here.
	p[0] = cos(h) * d[0] - sin(h) * d[2];
	p[1] = d[1];
	p[2] = sin(h) * d[0] + cos(h) * d[2];
	q[0] = p[0];
	q[1] = cos(v) * p[1] - sin(v) * p[2];
	q[2] = sin(v) * p[1] + cos(v) * p[2];
	angles_of(out, q);
}

struct gaze_sim *gaze_sim_new(const struct gaze_conf *conf, gaze_source *source, void *ctx, uint64_t seed)
{
	struct gaze_sim *s = mem_new(1, sizeof *s);
	s->conf = *conf;
	s->source = source;
	s->ctx = ctx;
	s->rng.state = seed;
	return s;
}

void gaze_sim_free(struct gaze_sim *s)
{
	if (s)
		free(s->done);
	free(s);
}

const struct gaze_saccade *gaze_sim_saccades(const struct gaze_sim *s, int *n)
{
	*n = s->n_done;
	return s->done;
}

static double past(const struct gaze_sim *s, double delay, int k)
{
	long back = lround(delay / step_s);
	back = back < 0 ? 0 : back >= HISTORY ? HISTORY - 1 : back;
	return s->now < back ? 0 : s->slip[(s->now - back) % HISTORY][k];
}

static double drawn(struct rng *rng, const double normal[2])
{
	return fmax(0.3 * normal[0], normal[0] + normal[1] * rng_normal(rng));
}

/* Input velocity of pursuit: the target's, and the part of the head's that the vestibulo-ocular reflex leaves. */
static void sense(struct gaze_sim *s, double head_speed[2])
{
	double *slip = s->slip[s->now % HISTORY], speed[2];
	for (int k = 0; k < 2; k++) {
		speed[k] = (s->input.target[k] - s->last.target[k]) / step_s;
		head_speed[k] = (s->input.head[k] - s->last.head[k]) / step_s;
	}
	bool jump = hypot(speed[0], speed[1]) > jump_speed;
	for (int k = 0; k < 2; k++)
		slip[k] = (jump ? 0 : speed[k]) - (1 - s->conf.vor_gain) * head_speed[k];
	s->near[s->now % HISTORY] = isinf(s->input.distance) ? 0 : 1 / s->input.distance;
}

/* True when pursuit alone will bring the eye onto the target within conf.crossing, extrapolating the error linearly. */
static bool will_cross(const struct gaze_sim *s, const double error[2], double length)
{
	double closing = 0;
	for (int k = 0; k < 2; k++)
		closing -= error[k] / length * (past(s, 0, k) - s->pursuit[k]);
	double crossing = closing > 0 ? length / closing : INFINITY;
	return crossing >= s->conf.crossing[0] && crossing <= s->conf.crossing[1];
}

static void plan_saccade(struct gaze_sim *s, const double error[2], double t)
{
	double length = hypot(error[0], error[1]);
	if (s->moving || s->pending || t < s->rest_until || length <= s->conf.threshold)
		return;
	bool moves = hypot(s->pursuit[0], s->pursuit[1]) > 1 || s->catch_up;
	s->begin = t + drawn(&s->rng, moves ? s->conf.catch_up : s->conf.latency);
	s->pending = true;
}

/* Cancels a pending saccade that pursuit makes needless, no later than crossing_lead before its start. */
static void decide_saccade(struct gaze_sim *s, const double error[2], double t)
{
	double length = hypot(error[0], error[1]);
	if (s->pending && t < s->begin - s->conf.crossing_lead + 0.5 * step_s && length > 0 && will_cross(s, error, length))
		s->pending = false;

}

/* Starts a saccade to where the target will be when it ends. */
static void begin_saccade(struct gaze_sim *s, const double error[2], double t)
{
	double length = hypot(error[0], error[1]);
	s->pending = false;
	if (length <= s->conf.threshold)
		return;
	double gain = s->conf.gain[0] + s->conf.gain[1] * rng_normal(&s->rng);
	double ahead = s->conf.saccade.duration_s + s->conf.saccade.duration_per_deg * length;
	for (int k = 0; k < 2; k++) {
		double aim = error[k] + (past(s, s->conf.pursuit_delay, k) - s->pursuit[k]) * ahead;
		s->way[k] = aim * gain;
		double to = s->eye[k] + s->way[k];
		s->way[k] += fmin(s->conf.range, fmax(-s->conf.range, to)) - to;
		s->origin[k] = 0;
	}
	double amplitude = hypot(s->way[0], s->way[1]);
	if (amplitude < 0.01)
		return;
	saccade_make(&s->saccade, amplitude, &s->conf.saccade);
	s->moving = true;
	s->begin = t;
	s->done = mem_grow(s->done, (size_t)s->n_done + 1, sizeof *s->done);
	s->done[s->n_done++] = (struct gaze_saccade){ t, amplitude, s->saccade.duration, s->saccade.peak };
}

static void move(struct gaze_sim *s, const double head_speed[2], double t)
{
	const struct gaze_conf *c = &s->conf;
	for (int k = 0; k < 2; k++) {
		double asked = c->pursuit_gain * past(s, c->pursuit_delay, k);
		asked = fmin(c->pursuit_limit, fmax(-c->pursuit_limit, asked));
		s->pursuit[k] += step_s / c->pursuit_tau * (asked - s->pursuit[k]);
		s->eye[k] += step_s * (s->pursuit[k] - c->vor_gain * head_speed[k]);
		if (s->moving) {
			double to = s->way[k] * saccade_at(&s->saccade, t - s->begin);
			s->eye[k] += to - s->origin[k];
			s->origin[k] = to;
		}
		s->eye[k] = fmin(c->range, fmax(-c->range, s->eye[k]));
		// Ornstein-Uhlenbeck process of variance drift^2.
		double back = step_s / c->drift_tau;
		s->drift[k] += -back * s->drift[k] + c->drift * sqrt(2 * back) * rng_normal(&s->rng);
	}
	if (s->moving && t >= s->begin + s->saccade.duration) {
		s->moving = false;
		s->catch_up = true;
		s->rest_until = t + 0.05;
	}
	long back = lround(c->vergence_delay / step_s);
	double to = s->now < back ? s->near[0] : s->near[(s->now - (back < HISTORY ? back : HISTORY - 1)) % HISTORY];
	s->nearness += step_s / c->vergence_tau * (to - s->nearness);
}

static void start(struct gaze_sim *s)
{
	s->source(s->ctx, 0, &s->input);
	s->last = s->input;
	in_head(s->eye, &s->input);
	s->nearness = isinf(s->input.distance) ? 0 : 1 / s->input.distance;
	s->near[0] = s->nearness;
	s->started = true;
}

static void advance(struct gaze_sim *s)
{
	double t = (double)++s->now * step_s, head_speed[2], error[2], target[2];
	s->last = s->input;
	s->source(s->ctx, t, &s->input);
	sense(s, head_speed);
	in_head(target, &s->input);
	for (int k = 0; k < 2; k++) {
		target[k] = fmin(s->conf.range, fmax(-s->conf.range, target[k]));
		error[k] = target[k] - s->eye[k];
	}
	if (hypot(s->input.target[0] - s->last.target[0], s->input.target[1] - s->last.target[1]) > jump_speed * step_s)
		s->catch_up = false;
	plan_saccade(s, error, t);
	decide_saccade(s, error, t);
	if (s->pending && t >= s->begin)
		begin_saccade(s, error, t);
	move(s, head_speed, t);
}

void gaze_sim_at(struct gaze_sim *s, double t, struct gaze_output *out)
{
	if (!s->started)
		start(s);
	while ((double)(s->now + 1) * step_s <= t + 1e-9)
		advance(s);
	*out = (struct gaze_output){ .in_saccade = s->moving };
	for (int k = 0; k < 2; k++)
		out->cyclopean[k] = s->eye[k] + s->drift[k];
	gaze_eyes(out->eye, out->cyclopean, s->nearness > 0 ? 1 / s->nearness : INFINITY, s->conf.ipd);
}
