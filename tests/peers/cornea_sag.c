#include "tests/peers/cornea_sag.h"

#include <math.h>

#include "math/vec.h"
#include "optics/lightpath/path.h"

/* The conic's depth, and its first and second derivative along r over r. */
static double conic(const struct cornea *c, double r2, double *over_r, double *bend)
{
	// z = r² / (R + s), s = sqrt(R² - p r²); dz/dr = r / s; d²z/dr² = R² / s³. Beyond the equator: as steep as just before.
	double s2 = c->R * c->R - c->p * r2, s = sqrt(fmax(s2, 1e-3 * c->R * c->R));
	*over_r = 1 / s;
	*bend = c->p / (s * s * s);  // (d²z/dr² - dz/dr / r) / r²
	return r2 / (c->R + s);
}

double cornea_sag_depth(const struct cornea_sag *c, double x, double y, double g[2], double second[3])
{
	double over_r, bend, k = 1 / c->base.rim, z = conic(&c->base, x * x + y * y, &over_r, &bend);
	double px[5] = { 1, x * k }, py[5] = { 1, y * k }, dx = x * over_r, dy = y * over_r;
	double dxx = over_r + bend * x * x, dxy = bend * x * y, dyy = over_r + bend * y * y;
	for (int i = 2; i < 5; i++) {
		px[i] = px[i - 1] * px[1];
		py[i] = py[i - 1] * py[1];
	}
	for (int degree = 1, at = 0; degree <= 4; degree++)
		for (int j = 0; j <= degree; j++, at++) {
			int i = degree - j;
			double a = c->term[at];
			z += a * px[i] * py[j];
			dx += i ? a * k * i * px[i - 1] * py[j] : 0;
			dy += j ? a * k * j * px[i] * py[j - 1] : 0;
			dxx += i > 1 ? a * k * k * i * (i - 1) * px[i - 2] * py[j] : 0;
			dxy += i && j ? a * k * k * i * j * px[i - 1] * py[j - 1] : 0;
			dyy += j > 1 ? a * k * k * j * (j - 1) * px[i] * py[j - 2] : 0;
		}
	if (g) {
		g[0] = dx;
		g[1] = dy;
	}
	if (second) {
		second[0] = dxx;
		second[1] = dxy;
		second[2] = dyy;
	}
	return z;
}

void cornea_sag_normal(double n[3], const struct cornea_sag *c, double x, double y)
{
	double g[2];
	cornea_sag_depth(c, x, y, g, 0);
	n[0] = g[0];
	n[1] = g[1];
	n[2] = -1;
	vec_unit(n, n);
}

struct cornea_sag cornea_sag_toric(const struct cornea *flat, double steep, double axis, const double tilt[2], const double apex[2])
{
	struct cornea_sag c = { .base = *flat };
	double rim = flat->rim, s = sin(axis), co = cos(axis), more = 0.5 * (1 / steep - 1 / flat->R), fourth = 0.125 * flat->p * (1 / (steep * steep * steep) - 1 / (flat->R * flat->R * flat->R));
	c.base.two_surface = false;
	// The steep meridian's own sag less the flat one's, along u = x cos + y sin: u² and u² r² terms of the conics' series.
	const double u2[3] = { co * co, 2 * co * s, s * s };
	for (int j = 0; j < 3; j++) {
		c.term[2 + j] += more * u2[j] * rim * rim;
		c.term[9 + j] += fourth * u2[j] * pow(rim, 4);
		c.term[11 + j] += fourth * u2[j] * pow(rim, 4);
	}
	// A tilt, and an apex off the axis by less than a millimetre: the conic's own slope there, and its coma.
	for (int k = 0; k < 2; k++)
		c.term[k] += (tilt[k] - apex[k] / flat->R) * rim;
	double coma = -0.5 * flat->p / (flat->R * flat->R * flat->R) * rim * rim * rim;
	c.term[5] += coma * apex[0];
	c.term[6] += coma * apex[1];
	c.term[7] += coma * apex[0];
	c.term[8] += coma * apex[1];
	return c;
}

/* A point of the surface on its way. */
struct place {
	double x, y, g[2], H[3], size;  // gradient and Hessian of L; |g|
};

static void look(struct place *at, const struct cornea_sag *c, const double P[3], const double w[3])
{
	double s[2], b[3], z = cornea_sag_depth(c, at->x, at->y, s, b), n = c->base.n;
	double v[3] = { at->x - P[0], at->y - P[1], z - P[2] }, d = vec_norm(v), f = n / d;
	vec_unit(v, v);
	// L = n |K - P| - w·K; K_x = (1, 0, z_x), K_y = (0, 1, z_y).
	double q[3] = { n * v[0] - w[0], n * v[1] - w[1], n * v[2] - w[2] };
	double a[2] = { v[0] + s[0] * v[2], v[1] + s[1] * v[2] };
	at->g[0] = q[0] + s[0] * q[2];
	at->g[1] = q[1] + s[1] * q[2];
	at->H[0] = f * (1 + s[0] * s[0] - a[0] * a[0]) + q[2] * b[0];
	at->H[1] = f * (s[0] * s[1] - a[0] * a[1]) + q[2] * b[1];
	at->H[2] = f * (1 + s[1] * s[1] - a[1] * a[1]) + q[2] * b[2];
	at->size = hypot(at->g[0], at->g[1]);
}

/* Newton's steps, at most half a millimetre long, each cut back until it brings the gradient down. */
static void descend(struct place *at, const struct cornea_sag *c, const double P[3], const double w[3], int steps)
{
	look(at, c, P, w);
	for (int k = 0; k < steps && at->size > 1e-14; k++) {
		double det = at->H[0] * at->H[2] - at->H[1] * at->H[1];
		double step[2] = { (at->H[1] * at->g[1] - at->H[2] * at->g[0]) / det, (at->H[1] * at->g[0] - at->H[0] * at->g[1]) / det };
		double length = hypot(step[0], step[1]), part = length > 0.5 ? 0.5 / length : 1;
		struct place next = *at;
		for (int cut = 0; cut < 8 && !(next.size < at->size); cut++, part *= 0.5) {
			next.x = at->x + part * step[0];
			next.y = at->y + part * step[1];
			look(&next, c, P, w);
		}
		if (!(next.size < at->size))
			break;
		*at = next;
	}
}

static enum lightpath_status judge(const struct place *at, const struct cornea_sag *c, const double w[3])
{
	double N[3];
	cornea_sag_normal(N, c, at->x, at->y);
	return vec_dot(N, w) < 0 ? LIGHTPATH_GRAZING : hypot(at->x, at->y) > c->base.rim ? LIGHTPATH_BEYOND_RIM : LIGHTPATH_OK;
}

static const double settled = 1e-9;  // of the gradient

/* The shortest path inside the rim that starts all over the cornea lead to; false: none does. */
static bool search(struct place *best, const struct cornea_sag *c, const double P[3], const double w[3])
{
	enum { RINGS = 3, SPOKES = 8 };
	double least = INFINITY;
	for (int i = 0; i < RINGS * SPOKES; i++) {
		double r = c->base.rim * (i / SPOKES + 0.7) / RINGS, a = 2 * M_PI * (i % SPOKES) / SPOKES;
		struct place at = { .x = r * cos(a), .y = r * sin(a) };
		descend(&at, c, P, w, 40);
		if (at.size > settled || judge(&at, c, w) != LIGHTPATH_OK)
			continue;
		double z = cornea_sag_depth(c, at.x, at.y, 0, 0), v[3] = { at.x - P[0], at.y - P[1], z - P[2] };
		double length = c->base.n * vec_norm(v) - (w[0] * at.x + w[1] * at.y + w[2] * z);
		if (length < least) {
			least = length;
			*best = at;
		}
	}
	return isfinite(least);
}

enum lightpath_status cornea_sag_path(double K[3], const struct cornea_sag *c, const double P[3], const double w[3], int steps)
{
	enum lightpath_status status = path_shortest(K, &(struct path){ &c->base, P, 0, w });
	if (status == LIGHTPATH_NONE)
		return status;
	struct place at = { .x = K[0], .y = K[1] }, found;
	descend(&at, c, P, w, steps);
	status = judge(&at, c, w);
	// Near a focus the conic's own path may lie millimetres off, or be none.
	if ((status == LIGHTPATH_GRAZING || at.size > 1e-7) && search(&found, c, P, w)) {
		at = found;
		status = LIGHTPATH_OK;
	}
	K[0] = at.x;
	K[1] = at.y;
	K[2] = cornea_sag_depth(c, at.x, at.y, 0, 0);
	return status;
}
