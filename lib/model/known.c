#include "model/known.h"

#include <math.h>
#include <string.h>

static const double half_turn = 180, most_beyond = 10;

void known_all(struct known *k)
{
	*k = (struct known){ 0 };
	for (int eye = 0; eye < 2; eye++) {
		for (int i = 0; i < KNOWN_CORNERS; i++) {
			k->corner[eye][i][0] = i % 4 == 0 || i % 4 == 3 ? -half_turn : half_turn;
			k->corner[eye][i][1] = i % 4 < 2 ? -half_turn : half_turn;
		}
		k->torsion[eye][0] = -half_turn;
		k->torsion[eye][1] = half_turn;
	}
}

/* The frames' outermost gazes in directions all round. False: no gaze was measured. */
static bool outermost(double corner[KNOWN_CORNERS][2], double torsion[2], long n, const double *g, int stride)
{
	double far[KNOWN_CORNERS];
	bool any = false;
	for (int i = 0; i < KNOWN_CORNERS; i++)
		far[i] = -INFINITY;
	torsion[0] = INFINITY;
	torsion[1] = -INFINITY;
	for (long f = 0; f < n; f++) {
		const double *at = g + f * stride;
		if (!isfinite(at[0]) || !isfinite(at[1]))
			continue;
		any = true;
		for (int i = 0; i < KNOWN_CORNERS; i++) {
			double angle = 2 * M_PI * i / KNOWN_CORNERS, along = cos(angle) * at[0] + sin(angle) * at[1];
			if (along > far[i]) {
				far[i] = along;
				memcpy(corner[i], at, 2 * sizeof *at);
			}
		}
		torsion[0] = fmin(torsion[0], at[2]);
		torsion[1] = fmax(torsion[1], at[2]);
	}
	if (!(torsion[0] <= torsion[1]))
		torsion[0] = torsion[1] = 0;
	return any;
}

void known_of(struct known *k, long n, const double *g, int stride, double beyond)
{
	bool seen[2];
	known_all(k);
	struct known all = *k;
	for (int eye = 0; eye < 2; eye++)
		seen[eye] = outermost(k->corner[eye], k->torsion[eye], n, g + 5 * eye, stride);
	for (int eye = 0; eye < 2; eye++)
		if (!seen[eye]) {
			const struct known *from = seen[1 - eye] ? k : &all;
			memcpy(k->corner[eye], from->corner[1 - eye], sizeof k->corner[eye]);
			memcpy(k->torsion[eye], from->torsion[1 - eye], sizeof k->torsion[eye]);
		}
	k->beyond = beyond;
}

/* The hull's point nearest to x; false: x lies in the hull. */
static bool nearest(double p[2], const double corner[KNOWN_CORNERS][2], const double x[2])
{
	double least = INFINITY;
	bool inside = true, edges = false;
	for (int i = 0; i < KNOWN_CORNERS; i++) {
		const double *a = corner[i], *b = corner[(i + 1) % KNOWN_CORNERS];
		double e[2] = { b[0] - a[0], b[1] - a[1] }, d[2] = { x[0] - a[0], x[1] - a[1] }, square = e[0] * e[0] + e[1] * e[1];
		double t = square > 0 ? fmin(fmax((d[0] * e[0] + d[1] * e[1]) / square, 0), 1) : 0;
		double q[2] = { a[0] + t * e[0], a[1] + t * e[1] }, far = hypot(x[0] - q[0], x[1] - q[1]);
		if (far < least) {
			least = far;
			memcpy(p, q, sizeof q);
		}
		edges = edges || square > 0;
		inside = inside && e[0] * d[1] - e[1] * d[0] >= 0;
	}
	return !(inside && edges) && least > 0;
}

/* How far beyond, of a distance and of the most. */
static double further(double distance, double most)
{
	return most > 0 ? most * tanh(distance / most) : 0;
}

void known_hold(double gaze[3], const struct known *k, int eye)
{
	double p[2];
	if (nearest(p, k->corner[eye], gaze)) {
		double d[2] = { gaze[0] - p[0], gaze[1] - p[1] }, far = hypot(d[0], d[1]), low = INFINITY, high = -INFINITY;
		for (int i = 0; i < KNOWN_CORNERS; i++) {
			double along = (k->corner[eye][i][0] * d[0] + k->corner[eye][i][1] * d[1]) / far;
			low = fmin(low, along);
			high = fmax(high, along);
		}
		double more = further(far, 0.5 * k->beyond * (high - low)) / far;
		for (int c = 0; c < 2; c++)
			gaze[c] = p[c] + more * d[c];
	}
	const double *t = k->torsion[eye], most = 0.5 * k->beyond * (t[1] - t[0]);
	if (gaze[2] > t[1])
		gaze[2] = t[1] + further(gaze[2] - t[1], most);
	else if (gaze[2] < t[0])
		gaze[2] = t[0] - further(t[0] - gaze[2], most);
}

bool known_check(const struct known *k, const char *place, struct err *err)
{
	const double *angle = &k->corner[0][0][0];
	bool ok = k->beyond >= 0 && k->beyond <= most_beyond;
	for (int i = 0; i < 4 * KNOWN_CORNERS; i++)
		ok = ok && fabs(angle[i]) <= half_turn;
	for (int i = 0; i < 4; i++)
		ok = ok && fabs(k->torsion[i / 2][i % 2]) <= half_turn;
	return ok || err_set(err, "%s: gazes known: angles within 180 degrees, beyond within 0 .. %g", place, most_beyond);
}
