#include "track/clip/tapers.h"

#include <math.h>
#include <string.h>

#include "track/lid/line.h"

/* Near the corner, as a share of the width. Of five rendered heads, 144 to 279 openings each, 99 % stood apart there by 0.56 of their height at most; of a filmed eye whose upper margin lay on the lid, 10 px
 * too high, by 0.6 to 0.85. */
static const double near_corner = 0.92, blunt = 0.6;
static const double open_enough = 0.5;  // of the usual opening

/* How far the margins of a frame stand apart near the outer corner, as a share of how far they do at most; NAN where that is not told. */
static double taper(const struct eye_state *state)
{
	enum { STEPS = 24 };
	struct line margin[LIDS];
	const int n = state->lid_points;
	if (n < 3 || !isfinite(state->lid[LID_UPPER][0][0] + state->lid[LID_LOWER][0][0]))
		return NAN;
	for (int k = 0; k < LIDS; k++) {
		margin[k].n = n;
		memcpy(margin[k].p, state->lid[k], (size_t)n * sizeof *margin[k].p);
	}
	const double ends[2][2] = { { margin[0].p[0][0], margin[0].p[0][1] }, { margin[0].p[n - 1][0], margin[0].p[n - 1][1] } };
	double most = 0, end = NAN;
	for (int i = 1; i <= STEPS; i++) {
		double up[2], low[2];
		const double u = near_corner * i / STEPS;
		if (!line_passes(up, &margin[LID_UPPER], u, ends) || !line_passes(low, &margin[LID_LOWER], u, ends))
			continue;
		end = i == STEPS ? hypot(up[0] - low[0], up[1] - low[1]) : NAN;
		most = fmax(most, hypot(up[0] - low[0], up[1] - low[1]));
	}
	return most > 0 ? end / most : NAN;
}

void track_tapers(struct track_result *r, const struct track_subject *s)
{
	for (long f = 0; f < r->n && r->has_eyes && s->assumed; f++)
		for (int e = 0; e < SIDES; e++) {
			struct eye_state *state = &r->eyes.state[f][e];
			if (state->blink != BLINK_OPEN || !(state->openness > open_enough) || !(taper(state) > blunt))
				continue;
			for (int k = 0; k < LIDS; k++) {
				state->lid_confidence[k] = 0;
				for (int i = 0; i < LID_POINTS_MAX; i++)
					state->lid[k][i][0] = state->lid[k][i][1] = NAN;
			}
		}
}
