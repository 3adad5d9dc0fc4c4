/* The light path and the view ray through the cornea: error and time of each method on the same cases, in one run.
 *
 * How far from the limit: with AVX2 one vector of eight floats passes, for three steps, 3 × 104 additions and
 * multiplications and 110 for the start, 3 × 1 + 3 roots and 3 × 3 + 4 quotients: at 2 + 2 sums and products a cycle, a
 * root in 5 and a quotient in 3 cycles, about 105 + 70 cycles on a processor that overlaps nothing, 22 a solve; the slots
 * of loads and stores between the short loops are free beside that.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/light_case.h"

// Pieces whose inputs and outputs stay in the second-level cache; timed over so few that other programs seldom cut in.
enum { N = 65536, PIECE = 4096, TIMED = 2 * PIECE };
static const struct cornea generic = { .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85, .R_post = 6.5, .p_post = 0.75,
	                               .thickness = 0.55, .n_cornea = 1.376 };

static struct {
	struct light_case c[N];
	double P[3][N], W[3][N], K[3][N], truth[N][3];
	float p[3][N], w[3][N], k[3][N], sight[9][N];
	unsigned char status[N];
} *s;

/* One method on the first n cases. */
struct method {
	int n, steps;
	struct algorithm1_conf paper;
	struct cornea cornea;
};

static void draw(double grazing_from)
{
	struct rng rng = { 1 };
	const struct light_range range = { false, { 3.3, 3.3 }, 5.85, 90, { grazing_from, 89.9 } };
	for (int i = 0; i < N; i++) {
		light_case_draw(&s->c[i], &rng, &range);
		// Light from far away for all methods; the paper's takes points only.
		vec_add(s->c[i].C, s->c[i].K, 1e6, s->c[i].w);
		for (int k = 0; k < 3; k++) {
			s->p[k][i] = s->P[k][i] = s->c[i].P[k];
			s->w[k][i] = s->W[k][i] = s->c[i].w[k];
		}
		double P[3] = { s->p[0][i], s->p[1][i], s->p[2][i] }, w[3] = { s->w[0][i], s->w[1][i], s->w[2][i] };
		lightpath_solve_directional(s->truth[i], &generic, P, w);  // of the inputs in float
	}
}

static void paper(void *ctx)
{
	struct method *m = ctx;
	for (int i = 0; i < m->n; i++) {
		double K[3];
		lightpath_algorithm1(K, &generic, s->c[i].P, s->c[i].C, &m->paper);
		for (int k = 0; k < 3; k++)
			s->K[k][i] = K[k];
	}
}

static void one_by_one(void *ctx)
{
	struct method *m = ctx;
	for (int i = 0; i < m->n; i++) {
		double K[3];
		lightpath_solve_directional(K, &generic, s->c[i].P, s->c[i].w);
		for (int k = 0; k < 3; k++)
			s->K[k][i] = K[k];
	}
}

static void in_double(void *ctx)
{
	struct method *m = ctx;
	for (int i = 0; i < m->n; i += PIECE)
		lightpath_batch_double(PIECE, s->P[0] + i, s->P[1] + i, s->P[2] + i, s->W[0] + i, s->W[1] + i, s->W[2] + i,
		                       s->K[0] + i, s->K[1] + i, s->K[2] + i, s->status, &generic, m->steps);
}

static void in_float(void *ctx)
{
	struct method *m = ctx;
	for (int i = 0; i < m->n; i += PIECE)
		lightpath_batch(PIECE, s->p[0] + i, s->p[1] + i, s->p[2] + i, s->w[0] + i, s->w[1] + i, s->w[2] + i,
		                s->k[0] + i, s->k[1] + i, s->k[2] + i, s->status, &generic, m->steps);
}

static double worst_double(int n, double *snell)
{
	double worst = 0;
	*snell = 0;
	for (int i = 0; i < n; i++) {
		double K[3] = { s->K[0][i], s->K[1][i], s->K[2][i] }, e[3];
		vec_add(e, K, -1, s->c[i].K);
		worst = fmax(worst, vec_norm(e));
		*snell = fmax(*snell, light_case_snell(&generic, s->c[i].P, 0, s->c[i].w, K));
	}
	return worst;
}

static double worst_float(int n)
{
	double worst = 0;
	for (int i = 0; i < n; i++) {
		double e[3] = { s->k[0][i] - s->truth[i][0], s->k[1][i] - s->truth[i][1], s->k[2][i] - s->truth[i][2] };
		worst = fmax(worst, vec_norm(e));
	}
	return worst;
}

static struct bench_time each(struct bench_time t, int n)
{
	return (struct bench_time){ t.median / n, t.low / n, t.high / n };
}

static void row(const char *table, const char *method, const char *setting, struct bench_time t, int n, double error)
{
	bench_row(table, method, setting, each(t, n), "solve", error, "mm", "K, worst");
}

static void algorithm1(const char *table)
{
	const double alphas[] = { 0.05, 0.5 };
	for (int a = 0; a < COUNT(alphas); a++) {
		for (int steps = 10; steps <= 1000; steps *= 10) {
			for (int planes = 1; planes <= 20; planes *= 20) {
				struct method m = { .n = 200000 / steps / planes, .paper = { alphas[a], 0, 1e-6, steps, planes } };
				m.n = m.n > 2000 ? 2000 : m.n < 100 ? 100 : m.n;
				char setting[80];
				snprintf(setting, sizeof setting, "alpha %g mm, %d steps, %s", alphas[a], steps,
				         planes > 1 ? "20 planes" : "one plane");
				struct bench_time t = bench_time(paper, &m, 3);
				double snell;
				row(table, "algorithm 1 (paper)", setting, t, m.n, worst_double(m.n, &snell));
			}
		}
	}
}

/* AVX-512 doubles the vectors, and the bar. */
static double float_bar(void)
{
#if defined(__x86_64__)
	return __builtin_cpu_supports("avx512f") ? 10 : 20;
#else
	return 20;
#endif
}

/* Timed over some of the cases; then all of them, for their error. */
static struct bench_time timed(void (*fn)(void *), struct method *m, int reps)
{
	m->n = TIMED;
	struct bench_time t = bench_time(fn, m, reps);
	m->n = N;
	fn(m);
	return t;
}

static void newton(const char *table, bool goals)
{
	struct method m = { 0 };
	char setting[40];
	double snell, worst;
	struct bench_time t = timed(one_by_one, &m, 9);
	worst = worst_double(m.n, &snell);
	row(table, "Newton, double", "one by one", t, TIMED, worst);
	if (goals) {
		bench_goal("light path: error, double: K", "<= 1e-12 mm to 89.9 degrees", worst, "mm", worst <= 1e-12);
		bench_goal("light path: error, double: Snell", "<= 1e-12 to 89.9 degrees", snell, "", snell <= 1e-12);
	}
	for (m.steps = 3; m.steps <= 5; m.steps++) {
		t = timed(in_double, &m, 60);
		worst = worst_double(m.n, &snell);
		snprintf(setting, sizeof setting, "%d steps", m.steps);
		row(table, "Newton, double, batch", setting, t, TIMED, worst);
		if (goals && m.steps == 5) {
			bench_goal("light path: time, double", "<= 100 ns a solve a core", 1e9 * t.median / TIMED, "ns", t.median / TIMED <= 1e-7);
			bench_goal("light path: error, double batch: K", "<= 1e-12 mm", worst, "mm", worst <= 1e-12);
		}
	}
	for (m.steps = 2; m.steps <= 4; m.steps++) {
		t = timed(in_float, &m, 100);
		worst = worst_float(m.n);
		snprintf(setting, sizeof setting, "%d steps", m.steps);
		row(table, "Newton, float, batch", setting, t, TIMED, worst);
		if (goals && m.steps == 3) {
			char reach[60];
			snprintf(reach, sizeof reach, "<= %g ns a solve a core", float_bar());
			bench_goal("light path: time, float", reach, 1e9 * t.median / TIMED, "ns", 1e9 * t.median / TIMED <= float_bar());
			bench_goal("light path: error, float", "<= 2e-5 mm", worst, "mm", worst <= 2e-5);
		}
	}
}

static const double camera[3] = { 20, -15, -75 };

static void to_the_plane(void *ctx)
{
	struct method *m = ctx;
	for (int i = 0; i < m->n; i += PIECE)
		cornea_sight_plane(PIECE, s->w[0] + i, s->w[1] + i, s->w[2] + i, s->k[0] + i, s->k[1] + i, 3.3, &m->cornea, camera);
}

static void to_directions(void *ctx)
{
	struct method *m = ctx;
	for (int i = 0; i < m->n; i += PIECE) {
		float *o[9];
		for (int k = 0; k < 9; k++)
			o[k] = s->sight[k] + i;
		cornea_sight_batch(&(struct sight_rays){ PIECE, s->w[0] + i, s->w[1] + i, s->w[2] + i, o[0], o[1], o[2], o[3],
		                                         o[4], o[5], o[6], o[7], o[8], s->status + i }, &m->cornea, camera);
	}
}

/* The rays TIMES over on all cores; long enough that waiting for a core that is busy elsewhere weighs little. */
enum { TIMES = 200 };
static void on_all_cores(void *ctx)
{
	struct method *m = ctx;
#pragma omp parallel for schedule(dynamic, 16)
	for (int j = 0; j < TIMES * (N / PIECE); j++) {
		int i = j % (N / PIECE) * PIECE;
		cornea_sight_plane(PIECE, s->w[0] + i, s->w[1] + i, s->w[2] + i, s->k[0] + i, s->k[1] + i, 3.3, &m->cornea, camera);
	}
}

/* Worst distance on the plane against single rays in double of another cornea model. */
static double plane_error(const struct cornea *truth, double *mean)
{
	double worst = 0, sum = 0;
	int n = 0;
	for (int i = 0; i < N; i++) {
		double d[3] = { s->w[0][i], s->w[1][i], s->w[2][i] }, K[3], from[3], in[3];
		if (!cornea_sight(K, from, in, truth, camera, d) || !isfinite(s->k[0][i]))
			continue;
		double t = (3.3 - from[2]) / in[2], x = from[0] + t * in[0], y = from[1] + t * in[1];
		if (hypot(x, y) > 5.85)
			continue;
		double e = hypot(s->k[0][i] - x, s->k[1][i] - y);
		worst = fmax(worst, e);
		sum += e;
		n++;
	}
	*mean = sum / n;
	return worst;
}

static void sight(void)
{
	const char *table = "view ray through the cornea";
	struct rng rng = { 2 };
	for (int i = 0; i < N; i++) {
		double a = rng_range(&rng, 0, 2 * M_PI), r = 5.8 * sqrt(rng_uniform(&rng)), d[3];
		vec_add(d, (double[]){ r * cos(a), r * sin(a), cornea_depth(&generic, r) }, -1, camera);
		vec_unit(d, d);
		for (int k = 0; k < 3; k++)
			s->w[k][i] = d[k];
	}
	struct method m = { .n = N, .cornea = generic };
	double mean, worst;
	for (int two = 0; two < 2; two++) {
		m.cornea.two_surface = two;
		struct bench_time full = timed(to_directions, &m, 100), t = timed(to_the_plane, &m, 100);
		worst = plane_error(&m.cornea, &mean);
		const char *setting = two ? "two surfaces" : "one surface";
		struct bench_time cores = bench_time(on_all_cores, &m, 5);
		bench_row(table, "to the iris plane, one core", setting, each(t, TIMED), "ray", worst, "mm", "place on the iris, worst");
		bench_row(table, "to the iris plane, all cores", setting, each(cores, N * TIMES), "ray", worst, "mm",
		          "place on the iris, worst");
		bench_row(table, "to directions, one core", setting, each(full, TIMED), "ray", NAN, "mm", "place on the iris, worst");
		if (two)
			continue;
		bench_goal("view ray through the cornea: speed, 2 × one core", ">= 250 Mray/s on 2 cores", 2e-6 * TIMED / t.median, "Mray/s",
		           2 * TIMED / t.median >= 250e6);
		bench_goal("view ray through the cornea: error", "<= 1e-6 mm", worst, "mm", worst <= 1e-6);
	}
	struct cornea real = generic;
	real.two_surface = true;
	m.cornea = generic;
	const double indices[] = { 1.336, 1.3375, 1.376 };
	for (int i = 0; i < COUNT(indices); i++) {
		m.cornea.n = indices[i];
		to_the_plane(&m);
		worst = plane_error(&real, &mean);
		char setting[60];
		snprintf(setting, sizeof setting, "index %g for both surfaces, mean", indices[i]);
		bench_row("one surface in place of two", "one surface", setting, (struct bench_time){ NAN, NAN, NAN }, "ray", mean, "mm",
		          "place on the iris");
		snprintf(setting, sizeof setting, "index %g for both surfaces, worst", indices[i]);
		bench_row("one surface in place of two", "one surface", setting, (struct bench_time){ NAN, NAN, NAN }, "ray", worst,
		          "mm", "place on the iris");
	}
}

int main(int argc, char **argv)
{
	bench_open("lightpath", argc, argv);
	s = mem_new(1, sizeof *s);
	draw(0);
	algorithm1("light path, the whole hemisphere");
	newton("light path, the whole hemisphere", true);
	draw(80);
	newton("light path, 80 to 89.9 degrees of incidence", false);
	sight();
	free(s);
	return bench_close();
}
