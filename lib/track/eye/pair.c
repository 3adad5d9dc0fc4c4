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
}
