#include "track/clip/blink_lower.h"

#include <math.h>
#include <string.h>

/* Motion, from one frame to another, of the point of the mesh's margin nearest to p. */
static bool gone(double d[2], int n, const double (*from)[2], const double (*to)[2], const double p[2])
{
	double least = INFINITY;
	for (int i = 0; i < n; i++) {
		double off = hypot(p[0] - from[i][0], p[1] - from[i][1]);
		if (!(off < least) || !isfinite(to[i][0]))
			continue;
		least = off;
		for (int k = 0; k < 2; k++)
			d[k] = to[i][k] - from[i][k];
	}
	return isfinite(least);
}

/* True when the frame shows the lower margin of an open eye. */
static bool clear(const struct track_result *r, int side, long f)
{
	return f >= 0 && f < r->n && !r->lost_at[f] && r->eyes.state[f][side].blink == BLINK_OPEN && isfinite(r->eyes.state[f][side].lid[LID_LOWER][0][0]);
}

/* Frames first..last of a blink. */
static void carry(struct track_result *r, int side, long first, long last, int n, const double (*carried)[2])
{
	long from[2] = { first - 1, last + 1 };
	bool known[2] = { clear(r, side, from[0]), clear(r, side, from[1]) };
	for (long f = first; f <= last; f++) {
		struct eye_state *state = &r->eyes.state[f][side];
		double share = known[0] && known[1] ? (double)(f - from[0]) / (double)(from[1] - from[0]) : known[1];
		for (int i = 0; i < state->lid_points && isfinite(state->lid[LID_LOWER][0][0]); i++) {
			double sum[2] = { 0 }, weight = 0;
			for (int k = 0; k < 2; k++) {
				double d[2] = { 0 }, w = k ? share : 1 - share;
				const double *p = known[k] ? r->eyes.state[from[k]][side].lid[LID_LOWER][i] : 0;
				if (!p || !gone(d, n, carried + from[k] * n, carried + f * n, p))
					continue;
				for (int c = 0; c < 2; c++)
					sum[c] += w * (p[c] + d[c]);
				weight += w;
			}
			for (int c = 0; c < 2 && weight > 0; c++)
				state->lid[LID_LOWER][i][c] = sum[c] / weight;
		}
	}
}

void blink_lower_carry(struct track_result *r, int side, int n, const double (*carried)[2])
{
	for (long f = 0; f < r->n; f++) {
		long last = f;
		if (r->eyes.state[f][side].blink == BLINK_OPEN)
			continue;
		while (last + 1 < r->n && r->eyes.state[last + 1][side].blink != BLINK_OPEN)
			last++;
		carry(r, side, f, last, n, carried);
		f = last;
	}
}
