/* Lashes. */
#include <math.h>

#include "math/vec.h"
#include "rig/hair/impl.h"

bool lash_root(struct front_hit *root, const struct front *f, double x, double from, bool upper, double away)
{
	const double step = upper ? 0.05 : -0.05;
	struct front_hit hit;
	double gone = 0, was = NAN;
	for (int k = 1; k <= 80; k++) {
		if (!front_skin(&hit, f, x, from + k * step))
			return false;
		// The first step off the margin leads over its rounding, however deep that is.
		gone += isnan(was) ? 0 : fmin(hypot(step, hit.z - was), 0.4);
		was = hit.z;
		if (gone >= away) {
			*root = hit;
			return true;
		}
	}
	return false;
}

/* How broad a lid's margin is at x: to where skin turns to the front, which it does within a little of where the eyeball ends. 0: it does not. */
static double breadth(const struct front *f, double x, double from, bool upper)
{
	static const double step = 0.05, within = 0.85, faces = 0.6;
	double gone = 0, was = NAN;
	for (int k = 1; k * step <= within; k++) {
		struct front_hit hit;
		const double y = from + (upper ? k : -k) * step;
		if (!front_skin(&hit, f, x, y))
			return 0;
		gone += isnan(was) ? 0 : fmin(hypot(step, hit.z - was), 0.4);
		was = hit.z;
		if (vec_dot(hit.normal, (double[]){ x, y, hit.z }) > faces * vec_norm((double[]){ x, y, hit.z }))
			return gone;
	}
	return 0;
}

/* What hairs of a clump have in common. */
struct clump {
	double place, fan, lift;
	int left;
};

/* Its points about the root: off the eyeball, along the lid, up over it. */
static void curve(double local[HAIR_LASH_POINTS][3], double length, double fan, double lift, double curl, bool upper)
{
	for (int k = 0; k < HAIR_LASH_POINTS; k++) {
		const double s = (double)k / (HAIR_LASH_POINTS - 1);
		local[k][0] = length * (0.95 * s - 0.25 * s * s) - (k ? 0 : 0.1);  // it comes out of the skin
		local[k][1] = length * fan * (0.45 * s + 0.2 * s * s);
		local[k][2] = length * lift * (upper ? -0.42 * s + (0.60 + 0.33 * curl) * s * s : -0.15 * s - (0.28 + 0.33 * curl) * s * s);
	}
}

struct lash_growth lash_average(const struct hair_conf *conf, int kind)
{
	return kind == HAIR_UPPER ? (struct lash_growth){ conf->lash_mm, 0, conf->lashes } : (struct lash_growth){ 0.4 * conf->lash_mm, 0, conf->lashes * 3 / 5 };
}

void lash_plant(struct hairs *h, const struct front *f, const struct front_opening *o, int kind, const struct lash_growth *g, double margin_mm, struct rng *rng)
{
	const bool upper = kind == HAIR_UPPER;
	const int hairs = (int)lrint(g->n);
	struct clump c = { 0 };
	for (int i = 0; i < hairs; i++) {
		// None in the inner eighth: there the lids hold the tear ducts. 0 inner canthus, 1 outer.
		double place = 0.12 + 0.86 * (i + rng_range(rng, 0.1, 0.9)) / hairs;
		if (!c.left--)
			c = (struct clump){ place, rng_range(rng, -0.12, 0.12), rng_range(rng, 0.85, 1.15), rng_below(rng, 4) };
		const int at = o->first + (int)(place * (o->last - o->first));
		const double from = upper ? o->high[at] : o->low[at], x = front_column(at);
		const double broad = breadth(f, x, from, upper), astray = 0.5 * margin_mm * rng_range(rng, -0.4, 1);
		const double away = broad > margin_mm ? broad + 0.5 * astray : margin_mm + astray;
		const double length = g->mm * (upper ? 0.6 + 0.4 * sin(M_PI * fmin(place * 0.75 + 0.15, 1)) : 1) * rng_range(rng, 0.65, 1.05);
		// Tips of a clump come together.
		const double fan = 1.5 * (place - 0.42) + c.fan + 0.6 * (c.place - place) * (o->last - o->first) * FRONT_COLUMN / fmax(0.65 * length, 1) + rng_range(rng, -0.07, 0.07);
		const double lift = c.lift * rng_range(rng, 0.94, 1.06), half = rng_range(rng, 0.05, 0.068);
		struct front_hit root;
		double local[HAIR_LASH_POINTS][3];
		if (!lash_root(&root, f, x, from, upper, away))
			continue;
		curve(local, length, fan, lift, g->curl, upper);
		front_add_local(h, f, &root, kind, HAIR_LASH_POINTS, (const double(*)[3])local, half);
		front_clear(h, f);
	}
}
