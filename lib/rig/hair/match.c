/* Lashes as a film shows them. */
#include <math.h>
#include <stdlib.h>

#include "rig/hair/impl.h"

/* What is not known of a person's lashes before the film is seen, standard deviations: of ln length (9 +- 1.5 mm), of curl (assumption), of ln number; and
 * of what the film shows: ln reach, ln area. */
static const double length_sd = 0.17, curl_sd = 0.6, number_sd = 0.35, reach_sd = 0.1, area_sd = 0.3;
static const double shortest = 0.5, longest = 1.5, fewest = 0.2, most = 2.5, curl_most = 1.2;  // of the average
enum { ROUNDS = 3 };

/* Distance of a place of the front from the margin. */
static double away(const struct front_opening *o, bool upper, const double at[2])
{
	const double *y = upper ? o->high : o->low;
	double least = INFINITY;
	for (int i = o->first; i < o->last; i++) {
		const double dx = front_column(i + 1) - front_column(i), dy = y[i + 1] - y[i], px = at[0] - front_column(i), py = at[1] - y[i];
		const double t = fmin(fmax((px * dx + py * dy) / (dx * dx + dy * dy), 0), 1);
		least = fmin(least, hypot(px - t * dx, py - t * dy));
	}
	return least;
}

static double margin_length(const struct front_opening *o, bool upper)
{
	const double *y = upper ? o->high : o->low;
	double sum = 0;
	for (int i = o->first; i < o->last; i++)
		sum += hypot(FRONT_COLUMN, y[i + 1] - y[i]);
	return sum;
}

/* What the front shows of a lid's lashes of such a growth. */
static struct hair_lid shown(const struct front *f, const struct front_opening *o, int kind, const struct lash_growth *g, double margin_mm)
{
	struct rng rng = { 5 };
	struct hairs h = { 0 };
	double area = 0, sum = 0;
	lash_plant(&h, f, o, kind, g, margin_mm, &rng);
	for (int i = 0; i < h.n; i++) {
		const struct hair *hair = &h.hair[i];
		float at[HAIR_LASH_POINTS][3];
		double p[HAIR_LASH_POINTS][3];
		hair_place(at, &h, hair, f->rig, (const float(*)[3])f->rig->rest);
		for (int k = 0; k < hair->n; k++)
			front_of(p[k], f, at[k]);
		for (int k = 0; k + 1 < hair->n; k++) {
			const double breadth = (double)(hair_half(hair, k) + hair_half(hair, k + 1)) / f->scale, a = breadth * hypot(p[k + 1][0] - p[k][0], p[k + 1][1] - p[k][1]);
			area += a;
			sum += a * away(o, kind == HAIR_UPPER, (double[]){ 0.5 * (p[k][0] + p[k + 1][0]), 0.5 * (p[k][1] + p[k + 1][1]) });
		}
	}
	hairs_free(&h);
	return (struct hair_lid){ area / (0.87 * fmax(margin_length(o, kind == HAIR_UPPER), 1)), area > 0 ? sum / area : 0 };
}

static double within(double v, double low, double high)
{
	return fmin(fmax(v, low), high);
}

/* The growth that is most probable by what the film shows of a lid: seen from in front, hairs lie as far from the margin and hide as much. */
static struct lash_growth match(const struct front *f, const struct front_opening *o, int kind, const struct hair_conf *conf)
{
	const struct lash_growth average = lash_average(conf, kind);
	const struct hair_lid *film = conf->film ? &conf->film->lid[kind] : 0;
	struct lash_growth g = average;
	if (!film || !(film->area > 0 && film->reach > 0) || average.n < 1)
		return g;
	// The front tells how far lashes reach, not whether they are long or curled: by their priors both are the most probable (Gauss and Newton).
	struct hair_lid now = { 0 };
	for (int round = 0; round < ROUNDS; round++) {
		const double d = 0.2;
		const struct lash_growth longer = { g.mm * exp(d), g.curl, g.n }, curled = { g.mm, g.curl + d, g.n };
		now = shown(f, o, kind, &g, conf->margin_mm);
		const struct hair_lid a = shown(f, o, kind, &longer, conf->margin_mm), b = shown(f, o, kind, &curled, conf->margin_mm);
		if (!(now.reach > 0 && a.reach > 0 && b.reach > 0))
			return average;
		const double by_length = log(a.reach / now.reach) / d, by_curl = log(b.reach / now.reach) / d, ln = log(g.mm / average.mm);
		const double off = log(film->reach / now.reach) + by_length * ln + by_curl * g.curl;
		const double pl = length_sd * length_sd * by_length, pc = curl_sd * curl_sd * by_curl, gain = off / (pl * by_length + pc * by_curl + reach_sd * reach_sd);
		g.mm = average.mm * within(exp(pl * gain), shortest, longest);
		g.curl = within(pc * gain, -curl_most, curl_most);
	}
	now = shown(f, o, kind, &g, conf->margin_mm);
	if (now.area > 0)
		g.n = average.n * within(exp(log(film->area / now.area) * number_sd * number_sd / (number_sd * number_sd + area_sd * area_sd)), fewest, most);
	return g;
}

void hairs_grow_lashes(struct hairs *h, const struct front *f, const struct front_opening *o, const struct hair_conf *conf, struct rng *rng)
{
	for (int kind = HAIR_UPPER; kind <= HAIR_LOWER && conf->lash_mm > 0; kind++) {
		const struct lash_growth g = match(f, o, kind, conf);
		lash_plant(h, f, o, kind, &g, conf->margin_mm, rng);
	}
}
