/* Lashes. */
#include <math.h>

#include "math/vec.h"
#include "rig/hair/impl.h"

/* Columns of the front, units apart, over what can be an eye's opening; rows in it; what is open less is a corner. */
enum { COLUMNS = 441, ROWS = 97, SMOOTH = 5 };
static const double column = 0.1, row = 0.25, least_open = 0.6, finest = 0.005;

/* Of each column where the eyeball shows: the ends of it. */
struct opening {
	int first, last;             // columns that are open, in a row
	double low[COLUMNS], high[COLUMNS];
};

static double x_of(int i) { return column * (i - COLUMNS / 2); }

static bool open_at(const struct front *f, double x, double y)
{
	struct front_hit hit;
	const double globe = front_globe(f, x, y);
	return isfinite(globe) && (!front_skin(&hit, f, x, y) || hit.z < globe);
}

/* Between y, which is open, and `beyond`, which is not. */
static double edge(const struct front *f, double x, double y, double beyond)
{
	while (fabs(beyond - y) > finest) {
		const double mid = 0.5 * (y + beyond);
		if (open_at(f, x, mid))
			y = mid;
		else
			beyond = mid;
	}
	return y;
}

static void look(struct opening *o, const struct front *f, int i)
{
	int best = 0, at = 0, run = 0;
	for (int k = 0; k <= ROWS; k++) {
		const bool open = k < ROWS && open_at(f, x_of(i), row * (k - ROWS / 2));
		if (!open && run > best) {
			best = run;
			at = k;
		}
		run = open ? run + 1 : 0;
	}
	o->low[i] = o->high[i] = 0;
	if (!best)
		return;
	const double top = row * (at - 1 - ROWS / 2), bottom = row * (at - best - ROWS / 2);
	o->high[i] = edge(f, x_of(i), top, top + row);
	o->low[i] = edge(f, x_of(i), bottom, bottom - row);
}

static void smoothed(double y[COLUMNS], int first, int last)
{
	double out[COLUMNS];
	for (int i = first; i <= last; i++) {
		const int reach = i - first < SMOOTH ? i - first : SMOOTH, k = last - i < reach ? last - i : reach;
		out[i] = 0;
		for (int j = i - k; j <= i + k; j++)
			out[i] += y[j] / (2 * k + 1);
	}
	for (int i = first; i <= last; i++)
		y[i] = out[i];
}

static bool opening_of(struct opening *o, const struct front *f)
{
	int widest = 0;
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < COLUMNS; i++)
		look(o, f, i);
	for (int i = 0; i < COLUMNS; i++)
		widest = o->high[i] - o->low[i] > o->high[widest] - o->low[widest] ? i : widest;
	if (!(o->high[widest] - o->low[widest] > 2 * least_open))
		return false;
	for (o->first = widest; o->first > 0 && o->high[o->first - 1] - o->low[o->first - 1] > least_open; o->first--)
		;
	for (o->last = widest; o->last + 1 < COLUMNS && o->high[o->last + 1] - o->low[o->last + 1] > least_open; o->last++)
		;
	smoothed(o->high, o->first, o->last);
	smoothed(o->low, o->first, o->last);
	return o->last - o->first > 50;
}

/* The skin `away` units from the margin at x, along the skin as a column of the front shows it. */
static bool root_at(struct front_hit *root, double *y, const struct front *f, double x, double from, bool upper, double away)
{
	const double step = upper ? 0.05 : -0.05;
	struct front_hit hit;
	double gone = 0, was = NAN;
	for (int k = 1; k <= 80; k++) {
		*y = from + k * step;
		if (!front_skin(&hit, f, x, *y))
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

/* What hairs of a clump have in common. */
struct clump {
	double place, fan, lift;
	int left;
};

/* Its points about the root: off the eyeball, along the lid, up over it. */
static void curve(double local[HAIR_LASH_POINTS][3], double length, double fan, double lift, bool upper)
{
	for (int k = 0; k < HAIR_LASH_POINTS; k++) {
		const double s = (double)k / (HAIR_LASH_POINTS - 1);
		local[k][0] = length * (0.95 * s - 0.25 * s * s) - (k ? 0 : 0.1);  // it comes out of the skin
		local[k][1] = length * fan * (0.45 * s + 0.2 * s * s);
		local[k][2] = length * lift * (upper ? -0.42 * s + 0.60 * s * s : -0.15 * s - 0.28 * s * s);
	}
}

static void plant(struct hairs *h, const struct front *f, const struct opening *o, bool upper, int hairs, const struct hair_conf *conf, struct rng *rng)
{
	struct clump c = { 0 };
	for (int i = 0; i < hairs; i++) {
		// None in the inner eighth: there the lids hold the tear ducts. 0 inner canthus, 1 outer.
		double place = 0.12 + 0.86 * (i + rng_range(rng, 0.1, 0.9)) / hairs, y;
		if (!c.left--)
			c = (struct clump){ place, rng_range(rng, -0.12, 0.12), rng_range(rng, 0.85, 1.15), rng_below(rng, 4) };
		const int at = o->first + (int)(place * (o->last - o->first));
		const double away = conf->margin_mm * (1 + 0.5 * rng_range(rng, -0.4, 1));
		const double length = conf->lash_mm * (upper ? 0.6 + 0.4 * sin(M_PI * fmin(place * 0.75 + 0.15, 1)) : 0.4) * rng_range(rng, 0.65, 1.05);
		// Tips of a clump come together.
		const double fan = 1.5 * (place - 0.42) + c.fan + 0.6 * (c.place - place) * (o->last - o->first) * column / fmax(0.65 * length, 1) + rng_range(rng, -0.07, 0.07);
		const double lift = c.lift * rng_range(rng, 0.94, 1.06), half = rng_range(rng, 0.05, 0.068);
		struct front_hit root;
		double local[HAIR_LASH_POINTS][3];
		if (!root_at(&root, &y, f, x_of(at), upper ? o->high[at] : o->low[at], upper, away))
			continue;
		curve(local, length, fan, lift, upper);
		front_add_local(h, f, &root, upper ? HAIR_UPPER : HAIR_LOWER, HAIR_LASH_POINTS, (const double(*)[3])local, half);
		front_clear(h, f);
	}
}

void hairs_grow_lashes(struct hairs *h, const struct front *f, const struct hair_conf *conf, struct rng *rng)
{
	struct opening o;
	if (!(conf->lash_mm > 0) || !opening_of(&o, f))
		return;
	plant(h, f, &o, true, conf->lashes, conf, rng);
	plant(h, f, &o, false, conf->lashes * 3 / 5, conf, rng);
}
