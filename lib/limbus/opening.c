#include "limbus/opening.h"

#include <math.h>

/* Semi-axes: from where on it is looked for, a step, how far the evidence's window reaches, how high; a gap that is no end: a lash, a vein. */
static const double FIRST = 0.9, STEP = 0.05, LAST = 3.1, HIGH = 1, GAP = 0.25;
static const double SHOWS = 0.5;

/* Chance that anything between the lids shows in a column of the picture. */
static double shows_at(const struct evidence *evidence, const struct ellipse *limbus, double x)
{
	double most = 0;
	for (double y = -HIGH; y <= HIGH; y += STEP)
		most = fmax(most, evidence_eye_at(evidence, limbus->cx + x * limbus->a, limbus->cy + y * limbus->a));
	return most;
}

void opening_reach(double reach[2], const struct evidence *evidence, const struct ellipse *limbus, int width)
{
	for (int side = 0; side < 2; side++) {
		const double sign = side ? 1 : -1;
		reach[side] = FIRST;
		for (double x = FIRST; x < LAST && x - reach[side] < GAP; x += STEP) {
			const double px = limbus->cx + sign * x * limbus->a;
			if (px < 0 || px > width) {
				reach[side] = 0;
				break;
			}
			if (shows_at(evidence, limbus, sign * x) > SHOWS)
				reach[side] = x + STEP / 2;
		}
	}
}

double opening_likelihood(const double reach[2], double aside, double limbus_radius, const struct opening_conf *conf)
{
	const double moved = (reach[0] - reach[1]) / 2 * limbus_radius / conf->arm, told = asin(fmax(fmin(moved, 1), -1)), off = (aside - told) / conf->sigma;
	return (1 - conf->misled) * exp(-0.5 * off * off) + conf->misled;
}
