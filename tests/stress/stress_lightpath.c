/* The light path in random cases whose K is known (light_case.h): no failure, no NaN, no wrong branch; one by one, and by the
 * batches in double and in float. 10^6 cases; --share=100: 10^8. Flagged: another path of the same problem, where there are several.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath/lightpath.h"
#include "optics/lightpath/path.h"
#include "tests/lib/truth/light_case.h"
#include "tests/lib/stress.h"

static const struct family {
	const char *name;
	struct light_range range;
	bool one_path;  // another physical path is wrong too
} families[] = {
	{ "generic eye, iris plane, hemisphere", { false, { 3.3, 3.3 }, 5.85, 90, { 0, 89.9 } }, true },
	{ "generic eye, iris plane, grazing", { false, { 3.3, 3.3 }, 5.85, 90, { 85, 89.9 } }, true },
	{ "generic eye, 2.5-5 mm deep, light from anywhere", { false, { 2.5, 5 }, 5.85, 135, { 0, 89.9 } }, false },
	{ "any cornea, hemisphere", { true, { 2.5, 5 }, 6, 90, { 0, 89.9 } }, false },
	{ "any cornea, grazing", { true, { 2.5, 5 }, 6, 90, { 88, 89.9 } }, false },
	{ "any cornea, light from anywhere", { true, { 2.5, 5 }, 6, 135, { 0, 89.9 } }, false },
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

static void describe(struct stress *s, const struct light_case *c, int point)
{
	const double *to = point ? c->C : c->w;
	stress_about(s, "R %.17g p %.17g n %.17g rim %.17g P %.17g %.17g %.17g %s %.17g %.17g %.17g; cos i %.3g", c->cornea.R, c->cornea.p,
	             c->cornea.n, c->cornea.rim, c->P[0], c->P[1], c->P[2], point ? "C" : "w", to[0], to[1], to[2], c->cos_i);
}

static void float_case(struct stress *s, const struct light_case *c, int point, bool one_path)
{
	struct light_case rounded;
	double K[3], want[3];
	enum lightpath_status got = in_float(K, &rounded, c, point), status = shortest(want, &rounded, point);
	bool found = got == LIGHTPATH_OK, sought = status == LIGHTPATH_OK, near = gap(K, want) <= 2e-5;
	if (!isfinite(K[0] + K[1] + K[2]))
		stress_wrong(s, "float: K is no number, status %d", got);
	else if (found && sought && near)
		stress_lost_of(s, gap(K, want) / c->cornea.R, (double)FLT_EPSILON);
	else if (found && !one_path && is_path(&rounded, point, K))
		stress_flagged(s);
	else if (found != sought && !on_the_edge(&rounded, point, want, 1e-4))
		stress_wrong(s, "float: status %d, in double %d", got, status);
	else if (found && sought)
		stress_wrong(s, "float: K off by %.2g mm", gap(K, want));
}

static void double_case(struct stress *s, const struct light_case *c, int point, bool one_path, bool batch)
{
	double tolerance = tolerance_of(c, point), K[3], want[3];
	const char *name = batch ? "batch" : "one by one";
	enum lightpath_status status = batch ? in_double(K, c, point)
	                               : point ? lightpath_solve(K, &c->cornea, c->P, c->C) : lightpath_solve_directional(K, &c->cornea, c->P, c->w);
	if (!isfinite(K[0] + K[1] + K[2])) {
		stress_wrong(s, "%s: K is no number, status %d", name, status);
		return;
	}
	if (status != LIGHTPATH_OK) {  // a batch may find none only where the shortest path is none, or on the edge
		if (!batch || (shortest(want, c, point) == LIGHTPATH_OK && !on_the_edge(c, point, want, 1e-9)))
			stress_wrong(s, "%s: status %d of a case with a path", name, status);
		return;
	}
	enum light_verdict verdict = light_case_judge(c, point, K, tolerance);
	if (verdict == LIGHT_WRONG || (verdict == LIGHT_OTHER_PATH && one_path))
		stress_wrong(s, "%s: K off by %.2g mm, %.2g expected of rounding; Snell's law by %.2g", name, gap(K, c->K), tolerance,
		             light_case_snell(&c->cornea, c->P, point ? c->C : 0, c->w, K));
	else if (verdict == LIGHT_OTHER_PATH)
		stress_flagged(s);
	else if (tolerance == 1e-12)  // else near a focus, where rounding of the case itself moves K further
		stress_lost(s, gap(K, c->K) / c->cornea.R);
}

int main(int argc, char **argv)
{
	struct stress s;
	stress_start(&s, "lightpath", argc, argv);
	for (int single = 0; single < 2; single++)
		for (int i = 0; i < COUNT(families); i++) {
			const struct family *f = &families[i];
			char *name = mem_printf("%s, %s", f->name, single ? "float" : "double");
			for (stress_family(&s, name, 83334); stress_case(&s);) {
				struct light_case c;
				light_case_draw(&c, &s.rng, &f->range);
				int point = rng_uniform(&s.rng) < 0.5;
				describe(&s, &c, point);
				if (single) {
					float_case(&s, &c, point, f->one_path);
					continue;
				}
				double_case(&s, &c, point, f->one_path, false);
				double_case(&s, &c, point, f->one_path, true);
			}
			free(name);
		}
	return stress_end(&s);
}
