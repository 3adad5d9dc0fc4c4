#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/eye/eye_track_impl.h"

// Radians: vertical disparity of fused vision; more would be seen double.
static const double LEVEL = 0.25 * M_PI / 180;
enum { LEAST = 10 };

/* Shifts all directions of an eye upwards, and its centre accordingly. */
static void lift(struct eye_side *eye, double up)
{
	for (long i = 0; i < eye->frames; i++)
		eye->state[i].gaze[1] += up;
	eye->globe.center[1] -= up * gaze_plane(&eye->globe);
}

/* Two eyes held level have one height, the mean of both by the other's variance. Light and lids shift both alike: their errors are taken for the same, so that
 * standard deviations are averaged and the less certain eye alone gains. */
static void share_height(struct eye_side *left, struct eye_side *right, const double var[2])
{
	struct eye_side *eye[2] = { left, right };
	const double joint = pow((var[1] * sqrt(var[0]) + var[0] * sqrt(var[1])) / fmax(var[0] + var[1], 1e-12), 2);
	for (int e = 0; e < 2; e++)
		for (long i = 0; i < eye[e]->frames; i++) {
			double *sigma = &eye[e]->state[i].sigma[1];
			*sigma = sqrt(fmax(*sigma * *sigma + joint - var[e], fmin(*sigma * *sigma, joint)));
		}
}

void eye_pair_level(struct eye_side *left, struct eye_side *right)
{
	long n = left->frames < right->frames ? left->frames : right->frames;
	double *off = mem_array((size_t)n + 1, sizeof *off), var[2], sum;
	int m = 0;
	for (long i = 0; i < n; i++)
		if (isfinite(left->state[i].gaze[1]) && isfinite(right->state[i].gaze[1]))
			off[m++] = left->state[i].gaze[1] - right->state[i].gaze[1];
	double apart = m ? stats_median(m, off) : 0;
	free(off);
	var[0] = pow(left->center_sigma[1] / fmax(1, gaze_plane(&left->globe)), 2);
	var[1] = pow(right->center_sigma[1] / fmax(1, gaze_plane(&right->globe)), 2);
	sum = var[0] + var[1] + LEVEL * LEVEL;
	// A disparity beyond three sigma of the measurement is strabismus and is left.
	if (m < LEAST || !(apart * apart < 9 * sum))
		return;
	lift(left, -apart * var[0] / sum);
	lift(right, apart * var[1] / sum);
	if (left->average && right->average)
		share_height(left, right, var);
}

/* The prior N(radius, sigma) of an eyeball's radius, and a measurement of it. */
static void join(struct eye_side *eye, double measured, double sigma)
{
	const double prior = 1 / (eye->radius_sigma * eye->radius_sigma), more = 1 / (sigma * sigma);
	eye->first_globe.radius = fmax(1.1 * eye->first_globe.limbus, (prior * eye->first_globe.radius + more * measured) / (prior + more));
	eye->radius_sigma = 1 / sqrt(prior + more);
}

void eye_pair_alike(struct eye_side *left, struct eye_side *right, double alike)
{
	double radius[2], sigma[2];
	if (!left->average || !right->average)
		return;
	const bool told[2] = { eye_side_radius(&radius[0], &sigma[0], left), eye_side_radius(&radius[1], &sigma[1], right) };
	if (told[1])
		join(left, radius[1], hypot(sigma[1], alike));
	if (told[0])
		join(right, radius[0], hypot(sigma[0], alike));
}

/* Median confidence of an eye's gaze where it is measured. */
static double usual_confidence(const struct eye_side *eye, long n, double *room)
{
	int m = 0;
	for (long i = 0; i < n; i++)
		if (eye->state[i].confidence > 0)
			room[m++] = eye->state[i].confidence;
	return m ? stats_median(m, room) : 1;
}

static void forget_gaze(struct eye_state *s)
{
	for (int k = 0; k < 3; k++)
		s->gaze[k] = s->sigma[k] = NAN;
	for (int k = 0; k < 5; k++)
		s->limbus[k] = NAN;
	s->confidence = 0;
}

void eye_pair_doubt(struct eye_side *left, struct eye_side *right, const double most_deg[2], double poor)
{
	long n = left->frames < right->frames ? left->frames : right->frames;
	double *room = mem_array((size_t)n + 1, sizeof *room), middle[2] = { 0 };
	int m = 0;
	for (int k = 0; k < 2; k++) {
		m = 0;
		for (long i = 0; i < n; i++)
			if (isfinite(left->state[i].gaze[k]) && isfinite(right->state[i].gaze[k]))
				room[m++] = left->state[i].gaze[k] - right->state[i].gaze[k];
		middle[k] = m ? stats_median(m, room) : 0;
	}
	const double usual[2] = { usual_confidence(left, n, room), usual_confidence(right, n, room) };
	free(room);
	for (long i = 0; m >= LEAST && i < n; i++) {
		struct eye_state *s[2] = { &left->state[i], &right->state[i] };
		bool apart = false;
		for (int k = 0; k < 2; k++) {
			// average eyeballs that are off look apart when they look aside
			const double common = left->average && right->average ? 2 * hypot(s[0]->sigma[k], s[1]->sigma[k]) : 0;
			apart = apart || fabs(s[0]->gaze[k] - s[1]->gaze[k] - middle[k]) > fmax(most_deg[k] * M_PI / 180, common);
		}
		const double trust[2] = { s[0]->confidence / usual[0], s[1]->confidence / usual[1] };
		for (int e = 0; e < 2 && apart; e++)
			if (trust[e] <= trust[!e] || trust[e] < poor)
				forget_gaze(s[e]);
	}
}
