/* The light path in 10^8 random cases whose K is known (light_case.h): no failure, no NaN, no wrong branch; one by one,
 * and by the batches in double and in float.
 *     stress_lightpath [cases [seed [family]]]
 * One line for each family; exit 1 when a case fails, with all that is needed to run it again. Runs of other seeds add up:
 * their cases are others.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath.h"
#include "optics/lightpath_path.h"
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

enum solver { ONE, DOUBLE, FLOAT, SOLVERS };
static const char *const solver_names[] = { "lightpath_solve", "lightpath_batch_double", "lightpath_batch" };

struct tally {
	long n, wrong[SOLVERS], other;
	double worst[SOLVERS];  // mm; of those in double over cases whose K is good to 1e-12
	struct light_case first;
	int first_point;
	enum solver first_solver;
};

/* The inputs are rounded to double: a K that moves 100 mm for 1 mm cannot be good to 1e-12. */
static double tolerance_of(const struct light_case *c, int point)
{
	double spread = c->spread[point];
	return fmax(1e-12, 4e-15 * spread * (1 + spread * 1e-6));
}

static double gap(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static enum lightpath_status in_double(double K[3], const struct light_case *c, int point)
{
	const double *P = c->P, *w = c->w;
	unsigned char status;
	if (point)
		lightpath_batch_point_double(1, P, P + 1, P + 2, c->C, K, K + 1, K + 2, &status, &c->cornea, 6);
	else
		lightpath_batch_double(1, P, P + 1, P + 2, w, w + 1, w + 2, K, K + 1, K + 2, &status, &c->cornea, 6);
	return status;
}

/* gcc 12 at -O3 leaves out a rounding whose result is widened again at once. */
static float to_float(double x)
{
	volatile float rounded = (float)x;
	return rounded;
}

/* The case in float, and *rounded: the same problem in double. */
static enum lightpath_status in_float(double K[3], struct light_case *rounded, const struct light_case *c, int point)
{
	float P[3], w[3], k[3];
	unsigned char status;
	*rounded = *c;
	for (int i = 0; i < 3; i++) {
		rounded->P[i] = (double)(P[i] = to_float(c->P[i]));
		rounded->w[i] = (double)(w[i] = to_float(c->w[i]));
	}
	if (point)
		lightpath_batch_point(1, P, P + 1, P + 2, c->C, k, k + 1, k + 2, &status, &c->cornea, 4);
	else
		lightpath_batch(1, P, P + 1, P + 2, w, w + 1, w + 2, k, k + 1, k + 2, &status, &c->cornea, 4);
	for (int i = 0; i < 3; i++)
		K[i] = (double)k[i];
	return status;
}

static enum lightpath_status shortest(double K[3], const struct light_case *c, int point)
{
	return path_shortest(K, &(struct path){ &c->cornea, c->P, point ? c->C : 0, point ? 0 : c->w });
}

/* A light path of its own to the precision of directions in float: lit, inside the rim, Snell's law kept. Near a focus K
 * itself is not determined better. */
static bool is_path(const struct light_case *c, int point, const double K[3])
{
	double u[3], N[3];
	path_outward(u, &(struct path){ &c->cornea, c->P, point ? c->C : 0, point ? 0 : c->w }, K);
	cornea_normal(N, &c->cornea, K);
	return u[0] * N[0] + u[1] * N[1] + u[2] * N[2] > -1e-4 && hypot(K[0], K[1]) < c->cornea.rim + 1e-4
	       && light_case_snell(&c->cornea, c->P, point ? c->C : 0, c->w, K) < 1e-6;
}

/* Whether the status hangs on the last digit: at the rim, or at grazing incidence. */
static bool on_the_edge(const struct light_case *c, int point, const double K[3], double digit)
{
	double u[3], N[3];
	path_outward(u, &(struct path){ &c->cornea, c->P, point ? c->C : 0, point ? 0 : c->w }, K);
	cornea_normal(N, &c->cornea, K);
	return fabs(hypot(K[0], K[1]) - cornea_edge(&c->cornea)) < digit || fabs(u[0] * N[0] + u[1] * N[1] + u[2] * N[2]) < digit;
}

/* Whether a solver does right by a case. one_path: another path than the case's is wrong. */
static bool is_right(struct tally *tally, enum solver solver, const struct light_case *c, int point, bool one_path)
{
	double tolerance = tolerance_of(c, point), K[3], want[3];
	struct light_case rounded;
	if (solver == FLOAT) {
		enum lightpath_status got = in_float(K, &rounded, c, point), status = shortest(want, &rounded, point);
		bool found = got == LIGHTPATH_OK, sought = status == LIGHTPATH_OK, near = gap(K, want) <= 2e-5;
		if (found && sought && near)
			tally->worst[FLOAT] = fmax(tally->worst[FLOAT], gap(K, want));
		if (found && !one_path && is_path(&rounded, point, K))
			return true;
		return isfinite(K[0] + K[1] + K[2]) && (found == sought ? near || !found : on_the_edge(&rounded, point, want, 1e-4));
	}
	enum lightpath_status status;
	if (solver == ONE)
		status = point ? lightpath_solve(K, &c->cornea, c->P, c->C) : lightpath_solve_directional(K, &c->cornea, c->P, c->w);
	else if ((status = in_double(K, c, point)) != LIGHTPATH_OK)
		return (shortest(want, c, point) != LIGHTPATH_OK || on_the_edge(c, point, want, 1e-9)) && isfinite(K[0] + K[1] + K[2]);
	enum light_verdict verdict = status == LIGHTPATH_OK ? light_case_judge(c, point, K, tolerance) : LIGHT_WRONG;
	tally->other += verdict == LIGHT_OTHER_PATH && solver == ONE;
	if (verdict == LIGHT_RIGHT && tolerance == 1e-12)
		tally->worst[solver] = fmax(tally->worst[solver], gap(K, c->K));
	return verdict == LIGHT_RIGHT || (verdict == LIGHT_OTHER_PATH && !one_path);
}

static long wrong_of(const struct tally *tally)
{
	return tally->wrong[ONE] + tally->wrong[DOUBLE] + tally->wrong[FLOAT];
}

static void one_case(struct tally *tally, const struct family *family, struct rng *rng)
{
	struct light_case c;
	light_case_draw(&c, rng, &family->range);
	int point = rng_uniform(rng) < 0.5;
	tally->n++;
	for (enum solver i = ONE; i < SOLVERS; i++) {
		if (is_right(tally, i, &c, point, family->one_path))
			continue;
		if (!wrong_of(tally)) {
			tally->first = c;
			tally->first_point = point;
			tally->first_solver = i;
		}
		tally->wrong[i]++;
	}
}

static void show(const struct tally *tally)
{
	const struct light_case *c = &tally->first;
	int point = tally->first_point;
	double K[3];
	int status = point ? lightpath_solve(K, &c->cornea, c->P, c->C)
	                   : lightpath_solve_directional(K, &c->cornea, c->P, c->w);
	printf("  first: %s: R %.17g p %.17g n %.17g rim %.17g\n  P %.17g %.17g %.17g\n  %s %.17g %.17g %.17g\n  K %.17g %.17g %.17g"
	       "\n  found %.17g %.17g %.17g, status %d, Snell off by %.1e; spread %g, cos i %g\n",
	       solver_names[tally->first_solver], c->cornea.R, c->cornea.p, c->cornea.n, c->cornea.rim, c->P[0], c->P[1], c->P[2], point ? "C" : "w",
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
			if (wrong_of(&tally) && !wrong_of(&all)) {
				all.first = tally.first;
				all.first_point = tally.first_point;
				all.first_solver = tally.first_solver;
			}
			all.n += tally.n;
			all.other += tally.other;
			for (int k = 0; k < SOLVERS; k++) {
				all.wrong[k] += tally.wrong[k];
				all.worst[k] = fmax(all.worst[k], tally.worst[k]);
			}
		}
	}
	printf("%-48s %10ld cases, several paths %ld; wrong %ld, double %ld, float %ld; K worst %.1e, %.1e, %.1e mm\n", family->name,
	       all.n, all.other, all.wrong[ONE], all.wrong[DOUBLE], all.wrong[FLOAT], all.worst[ONE], all.worst[DOUBLE],
	       all.worst[FLOAT]);
	if (wrong_of(&all))
		show(&all);
	fflush(stdout);
	return wrong_of(&all);
}

int main(int argc, char **argv)
{
	double cases = argc > 1 ? atof(argv[1]) : 1e6;
	uint64_t seed = argc > 2 ? strtoull(argv[2], 0, 10) : 1;
	int only = argc > 3 ? atoi(argv[3]) : -1;
	long wrong = 0;
	printf("stress_lightpath: %.0f cases, seed %llu\n", cases, (unsigned long long)seed);
	for (int i = 0; i < COUNT(families); i++)
		if (only < 0 || only == i)
			wrong += run(&families[i], (long)(cases / (only < 0 ? COUNT(families) : 1)), seed + (uint64_t)i);
	return wrong > 0;
}
