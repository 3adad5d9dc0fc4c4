#include "track/clip/blink_upper.h"

#include <math.h>
#include <string.h>

#include "math/stats.h"
#include "track/lid/line.h"

enum { SHARES = 24 };

/* Shares of the way from the inner corner to the outer between which lashes do not hide the margin: the closure is measured
 * there. */
static const double clear[2] = { 0.3, 0.65 };

static double share_of(int i)
{
	return 0.04 + 0.92 * i / (SHARES - 1);
}

/* Heights of a margin above the line between the corners of the eye, as shares of its length; beyond its ends constant. Returns
 * false when it is not known. */
static bool heights(double h[SHARES], const struct eye_state *state, int lid, const double ends[2][2])
{
	struct line line = { .n = state->lid_points };
	double dx = ends[1][0] - ends[0][0], dy = ends[1][1] - ends[0][1], square = dx * dx + dy * dy;
	memcpy(line.p, state->lid[lid], (size_t)line.n * sizeof *line.p);
	for (int i = 0; i < SHARES; i++) {
		double p[2];
		if (!(square > 1) || !isfinite(line.p[0][0]))
			return false;
		if (!line_passes(p, &line, share_of(i), ends))
			memcpy(p, line.p[share_of(i) < 0.5 ? 0 : line.n - 1], sizeof p);
		h[i] = (dx * (p[1] - ends[0][1]) - dy * (p[0] - ends[0][0])) / square;
	}
	return true;
}

static bool open_heights(double h[SHARES], const struct track_result *r, int side, long f, const double (*corner)[2][2])
{
	if (f < 0 || f >= r->n || r->lost_at[f] || r->eyes.state[f][side].blink != BLINK_OPEN)
		return false;
	return heights(h, &r->eyes.state[f][side], LID_UPPER, corner[f]);
}

/* One frame of a blink. open: the upper margin before and after it, heights. */
static void fall(struct eye_state *state, const double ends[2][2], const double open[SHARES], double near_px)
{
	double up[SHARES], low[SHARES], come[SHARES];
	struct line out = { 0 };
	int n = 0;
	if (!heights(up, state, LID_UPPER, ends) || !heights(low, state, LID_LOWER, ends))
		return;
	for (int i = 0; i < SHARES; i++)
		if (share_of(i) > clear[0] && share_of(i) < clear[1])
			come[n++] = (up[i] - open[i]) / (low[i] - open[i]);
	double closure = fmin(1, fmax(0, stats_median(n, come))), d[2] = { ends[1][0] - ends[0][0], ends[1][1] - ends[0][1] }, length = hypot(d[0], d[1]);
	if (!isfinite(closure))
		return;
	line_add(&out, ends[0]);
	for (int i = 0; i < SHARES; i++) {
		double at = open[i] + closure * (low[i] - open[i]), off = (up[i] - at) * length / near_px, u = share_of(i);
		at += (up[i] - at) / (1 + pow(off, 4));
		line_add(&out, (double[2]){ ends[0][0] + u * d[0] - at * d[1], ends[0][1] + u * d[1] + at * d[0] });
	}
	line_add(&out, ends[1]);
	line_spread(state->lid[LID_UPPER], state->lid_points, &out);
}

/* Interpolates the corners in frames first..last of a blink between those before and after it: under lashes skin is not
 * tracked. */
static void steady(double (*corner)[2][2], long first, long last, long frames, int n, const double (*carried)[2])
{
	long from[2] = { first - 1, last + 1 };
	for (long f = first; f <= last; f++)
		for (int c = 0; c < 2; c++)
			for (int k = 0; k < 2; k++) {
				double own[2], share = (double)(f - from[0]) / (double)(from[1] - from[0]);
				int place = c ? n - 1 : 0;
				for (int e = 0; e < 2; e++)
					own[e] = from[e] >= 0 && from[e] < frames ? corner[from[e]][c][k] - carried[from[e] * n + place][k] : NAN;
				share = isnan(own[0]) ? 1 : isnan(own[1]) ? 0 : share;
				double off = (share < 1 ? (1 - share) * own[0] : 0) + (share > 0 ? share * own[1] : 0);
				if (isfinite(off))
					corner[f][c][k] = carried[f * n + place][k] + off;
			}
}

void blink_upper_carry(struct track_result *r, int side, double (*corner)[2][2], int n, const double (*carried)[2], double near_px)
{
	for (long f = 0; f < r->n; f++) {
		long last = f;
		double was[SHARES], will[SHARES], open[SHARES];
		if (r->eyes.state[f][side].blink == BLINK_OPEN)
			continue;
		while (last + 1 < r->n && r->eyes.state[last + 1][side].blink != BLINK_OPEN)
			last++;
		steady(corner, f, last, r->n, n, carried);
		bool before = open_heights(was, r, side, f - 1, (const double(*)[2][2])corner), after = open_heights(will, r, side, last + 1, (const double(*)[2][2])corner);
		for (long g = f; g <= last && (before || after); g++) {
			double share = before && after ? (double)(g - f + 1) / (double)(last - f + 2) : after;
			for (int i = 0; i < SHARES; i++)
				open[i] = (before ? (1 - share) * was[i] : 0) + (after ? share * will[i] : 0);
			if (!r->lost_at[g] && isfinite(r->eyes.state[g][side].lid[LID_UPPER][0][0]))
				fall(&r->eyes.state[g][side], (const double(*)[2])corner[g], open, near_px);
		}
		f = last;
	}
}
