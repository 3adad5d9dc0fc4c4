/* The light path in 10^8 random cases whose K is known (light_case.h): no failure, no NaN, no wrong branch.
 *     stress_lightpath [cases [seed [family]]]
 * One line for each family; exit 1 when a case fails, with all that is needed to run it again.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath.h"
#include "tests/lib/light_case.h"

static const struct family {
	const char *name;
	struct light_range range;
	bool one_path;  // another physical path is a failure too
} families[] = {
	{ "generic eye, iris plane, hemisphere", { false, { 3.3, 3.3 }, 5.85, 90, { 0, 89.9 } }, true },
	{ "generic eye, iris plane, grazing", { false, { 3.3, 3.3 }, 5.85, 90, { 85, 89.9 } }, true },
	{ "generic eye, 2.5-5 mm deep, light from anywhere", { false, { 2.5, 5 }, 5.85, 135, { 0, 89.9 } }, false },
	{ "any cornea, hemisphere", { true, { 2.5, 5 }, 6, 90, { 0, 89.9 } }, false },
	{ "any cornea, grazing", { true, { 2.5, 5 }, 6, 90, { 88, 89.9 } }, false },
	{ "any cornea, light from anywhere", { true, { 2.5, 5 }, 6, 135, { 0, 89.9 } }, false },
};

struct tally {
	long n, wrong, other;
	double worst;      // mm, over cases whose K is good to 1e-12
	struct light_case first;
	int first_point;
};

/* The inputs are rounded to double: a K that moves 100 mm for 1 mm cannot be good to 1e-12. */
static double tolerance_of(const struct light_case *c, int point)
{
	double spread = c->spread[point];
	return fmax(1e-12, 4e-15 * spread * (1 + spread * 1e-6));
}

static void one_case(struct tally *tally, const struct family *family, struct rng *rng)
{
	struct light_case c;
	light_case_draw(&c, rng, &family->range);
	int point = rng_uniform(rng) < 0.5;
	double tolerance = tolerance_of(&c, point), K[3];
	enum lightpath_status status = point ? lightpath_solve(K, &c.cornea, c.P, c.C)
	                                     : lightpath_solve_directional(K, &c.cornea, c.P, c.w);
	enum light_verdict verdict = status == LIGHTPATH_OK ? light_case_judge(&c, point, K, tolerance) : LIGHT_WRONG;
	tally->n++;
	tally->other += verdict == LIGHT_OTHER_PATH;
	if (verdict == LIGHT_RIGHT && tolerance == 1e-12)
		tally->worst = fmax(tally->worst, hypot(hypot(K[0] - c.K[0], K[1] - c.K[1]), K[2] - c.K[2]));
	if (verdict == LIGHT_RIGHT || (verdict == LIGHT_OTHER_PATH && !family->one_path))
		return;
	if (!tally->wrong++) {
		tally->first = c;
		tally->first_point = point;
	}
}

static void show(const struct light_case *c, int point)
{
	double K[3];
	int status = point ? lightpath_solve(K, &c->cornea, c->P, c->C)
	                   : lightpath_solve_directional(K, &c->cornea, c->P, c->w);
	printf("  first: R %.17g p %.17g n %.17g rim %.17g\n  P %.17g %.17g %.17g\n  %s %.17g %.17g %.17g\n  K %.17g %.17g %.17g"
	       "\n  found %.17g %.17g %.17g, status %d, Snell off by %.1e; spread %g, cos i %g\n",
	       c->cornea.R, c->cornea.p, c->cornea.n, c->cornea.rim, c->P[0], c->P[1], c->P[2], point ? "C" : "w",
	       point ? c->C[0] : c->w[0], point ? c->C[1] : c->w[1], point ? c->C[2] : c->w[2], c->K[0], c->K[1], c->K[2],
	       K[0], K[1], K[2], status,
	       light_case_snell(&c->cornea, c->P, point ? c->C : 0, c->w, K), c->spread[point], c->cos_i);
}

/* In pieces of a seed each, so that the cases do not depend on the threads. */
static long run(const struct family *family, long cases, uint64_t seed)
{
	enum { PIECE = 10000 };
	struct tally all = { 0 };
	long pieces = (cases + PIECE - 1) / PIECE;
#pragma omp parallel for schedule(dynamic)
	for (long i = 0; i < pieces; i++) {
		struct rng rng = { seed + 0x9e3779b9u * (uint64_t)(i + 1) * 1000003u };
		struct tally tally = { 0 };
		for (int k = 0; k < PIECE; k++)
			one_case(&tally, family, &rng);
#pragma omp critical
		{
			if (tally.wrong && !all.wrong) {
				all.first = tally.first;
				all.first_point = tally.first_point;
			}
			all.n += tally.n;
			all.wrong += tally.wrong;
			all.other += tally.other;
			all.worst = fmax(all.worst, tally.worst);
		}
	}
	printf("%-50s %11ld cases, wrong %ld, several paths %ld, K worst %.1e mm\n", family->name, all.n, all.wrong, all.other,
	       all.worst);
	if (all.wrong)
		show(&all.first, all.first_point);
	fflush(stdout);
	return all.wrong;
}

int main(int argc, char **argv)
{
	double cases = argc > 1 ? atof(argv[1]) : 1e8;
	uint64_t seed = argc > 2 ? strtoull(argv[2], 0, 10) : 1;
	int only = argc > 3 ? atoi(argv[3]) : -1;
	long wrong = 0;
	printf("stress_lightpath: %.0f cases, seed %llu\n", cases, (unsigned long long)seed);
	for (int i = 0; i < COUNT(families); i++)
		if (only < 0 || only == i)
			wrong += run(&families[i], (long)(cases / (only < 0 ? COUNT(families) : 1)), seed + (uint64_t)i);
	return wrong > 0;
}
