/* The refraction function f(P, w) -> K: error against time of the paper's tables and of what replaces them, light from the
 * hemisphere, K inside the rim.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "optics/refraction/refraction.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/light_case.h"
#include "tests/lib/bench/storage.h"
#include "tests/peers/cornea_sag.h"

enum { N = 65536, TIMED = 4096 };  // timed over so few that other programs seldom cut in
static const struct cornea generic = { .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85 };

static struct {
	float p[3][N], w[3][N], k[3][N];
	double truth[N][3];
	unsigned char status[N];
} *s;

static void draw(void)
{
	struct rng rng = { 1 };
	const struct light_range range = { false, { 3.3, 3.3 }, 5.85, 90, { 0, 89.9 } };
	for (int i = 0; i < N; i++) {
		struct light_case c;
		light_case_draw(&c, &rng, &range);
		for (int k = 0; k < 3; k++) {
			s->p[k][i] = c.P[k];
			s->w[k][i] = c.w[k];
		}
		double P[3] = { s->p[0][i], s->p[1][i], s->p[2][i] }, w[3] = { s->w[0][i], s->w[1][i], s->w[2][i] };
		lightpath_solve_directional(s->truth[i], &generic, P, w);
	}
}

struct run {
	struct refraction f;
	int n;
};

static void evaluate(void *ctx)
{
	struct run *r = ctx;
	refraction_batch(&r->f, r->n, s->p[0], s->p[1], s->p[2], s->w[0], s->w[1], s->w[2], s->k[0], s->k[1], s->k[2],
	                 0, s->status);
}

/* Seconds of one evaluation, over some of the cases; then all of them, for their error. */
static struct bench_time timed(struct run *r)
{
	r->n = TIMED;
	struct bench_time t = bench_time(evaluate, r, 60);
	r->n = N;
	evaluate(r);
	return (struct bench_time){ t.median / TIMED, t.low / TIMED, t.high / TIMED };
}

static double worst(double *mean)
{
	double most = 0, sum = 0;
	for (int i = 0; i < N; i++) {
		const double *K = s->truth[i];
		double e = hypot(hypot(s->k[0][i] - K[0], s->k[1][i] - K[1]), s->k[2][i] - K[2]);
		most = fmax(most, e);
		sum += e;
	}
	*mean = sum / N;
	return most;
}

/* The same figures with the mean error, for a table of their own after the first. */
struct means {
	int n;
	struct mean_row {
		const char *method;
		char setting[120];
		struct bench_time time;
		double mean;
	} rows[40];
	struct storage_point points[40];  // of the same, with the worst error
};

static void show(const struct means *means)
{
	for (int i = 0; i < means->n; i++) {
		const struct mean_row *row = &means->rows[i];
		bench_row("refraction function, on average", row->method, row->setting, row->time, "evaluation", row->mean, "mm",
		          "K, mean");
	}
}

/* One row with the worst error, one kept for the mean; returns the seconds of one evaluation. bytes: null, or storage. */
static double measure(struct means *means, const char *method, const struct refraction_conf *conf, const char *label,
                      double *most, long *bytes)
{
	struct run r = { 0 };
	refraction_make(&r.f, &generic, conf);
	struct bench_time t = timed(&r);
	double mean;
	*most = worst(&mean);
	char setting[120];
	snprintf(setting, sizeof setting, "%s%s%d steps, %ld B", label, *label ? ", " : "", r.f.steps, refraction_bytes(&r.f));
	bench_row("refraction function", method, setting, t, "evaluation", *most, "mm", "K, worst");
	if (means->n < COUNT(means->rows)) {
		means->points[means->n] = (struct storage_point){ method, (double)refraction_bytes(&r.f), t.median, *most };
		struct mean_row *row = &means->rows[means->n++];
		*row = (struct mean_row){ .method = method, .time = t, .mean = mean };
		snprintf(row->setting, sizeof row->setting, "%s", setting);
	}
	if (bytes)
		*bytes = refraction_bytes(&r.f);
	refraction_free(&r.f);
	return t.median;
}

/* An asymmetric cornea: 4 dioptres of astigmatism, tilted, its apex 0.3 mm off, trefoil of 20 um. Paths built forwards, by Snell. */
struct odd {
	struct cornea_sag cornea;
	int n, steps;
	double P[20000][3], w[20000][3], K[20000][3], got[20000][3];
};

static struct odd *odd_new(void)
{
	struct odd *o = mem_new(1, sizeof *o);
	struct rng rng = { 17 };
	o->cornea = cornea_sag_toric(&generic, 7.15, 25 * M_PI / 180, (double[]){ 0.052, -0.035 }, (double[]){ 0.3, -0.1 });
	o->cornea.term[5] += 0.02;
	o->cornea.term[7] -= 0.06;
	while (o->n < COUNT(o->P)) {
		double *P = o->P[o->n], *w = o->w[o->n], *K = o->K[o->n], N_[3], in[3];
		double r = 5.8 * sqrt(rng_uniform(&rng)), a = rng_range(&rng, 0, 2 * M_PI), z = -rng_uniform(&rng), b = rng_range(&rng, 0, 2 * M_PI);
		K[0] = r * cos(a);
		K[1] = r * sin(a);
		K[2] = cornea_sag_depth(&o->cornea, K[0], K[1], 0, 0);
		w[0] = sqrt(1 - z * z) * cos(b);
		w[1] = sqrt(1 - z * z) * sin(b);
		w[2] = z;
		cornea_sag_normal(N_, &o->cornea, K[0], K[1]);
		if (vec_dot(w, N_) < 2e-3 || !refract(in, (double[]){ -w[0], -w[1], -w[2] }, N_, 1, generic.n))
			continue;
		vec_add(P, K, (3.3 - K[2]) / in[2], in);
		o->n += hypot(P[0], P[1]) < 5.8;
	}
	return o;
}

/* How far the ray that enters at K passes by P on its plane: another path where that is nothing. */
static double odd_miss(const struct odd *o, int i)
{
	const double *K = o->got[i], *w = o->w[i], *P = o->P[i];
	double N_[3], in[3];
	cornea_sag_normal(N_, &o->cornea, K[0], K[1]);
	if (vec_dot(w, N_) < 0 || hypot(K[0], K[1]) > generic.rim || !refract(in, (double[]){ -w[0], -w[1], -w[2] }, N_, 1, generic.n))
		return INFINITY;
	double t = (P[2] - K[2]) / in[2];
	return hypot(K[0] + t * in[0] - P[0], K[1] + t * in[1] - P[1]);
}

static void odd_solve(void *ctx)
{
	struct odd *o = ctx;
	for (int i = 0; i < o->n; i++)
		cornea_sag_path(o->got[i], &o->cornea, o->P[i], o->w[i], o->steps);
}

static void asymmetric(void)
{
	struct odd *o = odd_new();
	for (o->steps = 4; o->steps <= 6; o->steps++) {
		struct bench_time t = bench_time_each(bench_time(odd_solve, o, bench_quick() ? 2 : 8), o->n);
		double most = 0;
		int others = 0;
		for (int i = 0; i < o->n; i++) {
			double e = hypot(hypot(o->got[i][0] - o->K[i][0], o->got[i][1] - o->K[i][1]), o->got[i][2] - o->K[i][2]);
			bool other = e > 1e-3 && odd_miss(o, i) < 1e-8;
			others += other;
			most = other ? most : fmax(most, e);
		}
		char setting[96];
		snprintf(setting, sizeof setting, "%d steps, %zu B, %d of %d another path of two", o->steps, sizeof o->cornea, others, o->n);
		bench_row("refraction function, asymmetric cornea", "path through the conic + Newton, double", setting, t, "evaluation", most, "mm", "K, worst");
		if (o->steps == 6) {
			bench_goal("refraction function of an asymmetric cornea: error, worst", "<= 1e-3 mm", most, "mm", most <= 1e-3);
			bench_goal("refraction function of an asymmetric cornea: storage", "<= 6144 bytes", sizeof o->cornea, "B", sizeof o->cornea <= 6144);
		}
	}
	free(o);
}

int main(int argc, char **argv)
{
	bench_open("refraction", argc, argv);
	s = mem_new(1, sizeof *s);
	draw();
	struct means means = { 0 };
	double most, table_time = INFINITY, table_error = INFINITY;
	const int points[] = { 10, 100 }, directions[] = { 100, 2500 };
	for (int method = REFRACTION_TABLE_NEAREST; method >= REFRACTION_TABLE_LINEAR; method--) {
		for (int i = 0; i < COUNT(points); i++) {
			char label[40];
			snprintf(label, sizeof label, "%d x %d, %s", points[i], directions[i],
			         method == REFRACTION_TABLE_LINEAR ? "linear" : "nearest");
			double t = measure(&means, "table (paper)", &(struct refraction_conf){ method, 0, points[i], directions[i], 5.85, 3.3 },
			                   label, &most, 0);
			table_time = fmin(table_time, t);
			table_error = fmin(table_error, most);
		}
	}
	const double budgets[] = { 1e-1, 1e-2, 1e-3, 1e-4, 1e-5 };
	const char *const names[] = { "auto", "closed form + Newton", "polynomial + Newton" };
	for (int method = REFRACTION_NEWTON; method <= REFRACTION_POLYNOMIAL; method++)
		for (int i = 0; i < COUNT(budgets); i++) {
			char label[40];
			snprintf(label, sizeof label, "error_mm %g", budgets[i]);
			measure(&means, names[method], &(struct refraction_conf){ method, budgets[i], 0, 0, 5.85, 3.3 }, label, &most, 0);
		}
	long bytes;
	double t = measure(&means, "auto", &(struct refraction_conf){ REFRACTION_AUTO, 1e-4, 0, 0, 5.85, 3.3 }, "error_mm 0.0001", &most, &bytes);
	bench_goal("refraction function over the hemisphere: error, worst", "<= 1e-4 mm to 89.9 degrees", most, "mm", most <= 1e-4);
	bench_goal("refraction function: storage", "<= 2048 bytes", bytes, "B", bytes <= 2048);
	bench_goal("refraction function: time, one core", "<= 10 ns", 1e9 * t, "ns", t <= 1e-8);
	bench_goal("refraction function against the paper's tables: error", "below every table's", most, "mm", most < table_error);
	bench_goal("refraction function against the paper's tables: time", "below every table's", 1e9 * t, "ns", t < table_time);
	show(&means);
	if (!storage_plot(bench_out(), "refraction-storage", "The refraction function: storage, error, and time as the size of the mark", "K, worst, mm", means.n, means.points))
		fprintf(stderr, "bench_refraction: gnuplot draws no refraction-storage.svg\n");
	asymmetric();
	free(s);
	return bench_close();
}
