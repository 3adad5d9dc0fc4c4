/* The caustic: how much light the cornea gathers on each place of the iris. The closed form of lightpath_gain, which
 * stores nothing, against finite differences of the solved light path in double, and against photons traced by brute
 * force through plain Snell: within their own noise or not. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/light_case.h"
#include "tests/peers/fresnel.h"
#include "tests/peers/lightpath_gain.h"

enum { N = 20000, TIMED = 4096, CELLS = 24 };
static const struct cornea generic = { .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85 };

static struct {
	float p[3][N], w[3][N], k[3][N], gain[N];
	double P[N][3], W[N][3], K[N][3], truth[N];
} *s;

/* Irradiance gain from how far K moves with P: T cos i of the area that light of the area around P comes through. */
static double differences(const double P[3], const double w[3], const double K[3])
{
	const double h = 1e-4;  // mm: central differences are off by h² / 6 of the third derivative, and 1e-13 / h of rounding
	double moved[2][3], area[3], N_[3];
	for (int axis = 0; axis < 2; axis++) {
		double Q[3] = { P[0], P[1], P[2] }, a[3], b[3];
		Q[axis] = P[axis] + h;
		lightpath_solve_directional(a, &generic, Q, w);
		Q[axis] = P[axis] - h;
		lightpath_solve_directional(b, &generic, Q, w);
		for (int k = 0; k < 3; k++)
			moved[axis][k] = (a[k] - b[k]) / (2 * h);
	}
	vec_cross(area, moved[0], moved[1]);
	cornea_normal(N_, &generic, K);
	double cos_i = vec_dot(w, N_);
	return fresnel_transmittance(cos_i, 1, generic.n) * cos_i * vec_norm(area);
}

static void draw(void)
{
	struct rng rng = { 5 };
	const struct light_range range = { false, { 3.3, 3.3 }, 5.8, 90, { 0, 89 } };
	for (int i = 0; i < N; i++) {
		struct light_case c;
		light_case_draw(&c, &rng, &range);
		for (int k = 0; k < 3; k++) {
			s->P[i][k] = s->p[k][i] = (float)c.P[k];
			s->W[i][k] = s->w[k][i] = (float)c.w[k];
		}
		vec_unit(s->W[i], s->W[i]);
		lightpath_solve_directional(s->K[i], &generic, s->P[i], s->W[i]);
		for (int k = 0; k < 3; k++)
			s->k[k][i] = (float)s->K[i][k];
		s->truth[i] = differences(s->P[i], s->W[i], s->K[i]);
	}
}

static void by_differences(void *ctx)
{
	(void)ctx;
	for (int i = 0; i < TIMED; i++)
		s->gain[i] = (float)differences(s->P[i], s->W[i], s->K[i]);
}

static void in_double(void *ctx)
{
	(void)ctx;
	for (int i = 0; i < TIMED; i++)
		s->gain[i] = (float)lightpath_gain(&generic, s->P[i], s->W[i], s->K[i]);
}

static void in_float(void *ctx)
{
	lightpath_gain_batch(ctx ? N : TIMED, s->p[0], s->p[1], s->p[2], s->w[0], s->w[1], s->w[2], s->k[0], s->k[1], s->k[2],
	                     s->gain, &generic);
}

static void against_differences(void)
{
	void (*const fn[])(void *) = { by_differences, in_double, in_float };
	static const char *const names[] = { "finite differences, double", "closed form, double", "closed form, float batch" };
	void *const none[3] = { 0 };
	struct bench_time t[3];
	double worst[3] = { NAN };
	bench_times(3, t, fn, none, bench_quick() ? 3 : 20);
	in_float(s);
	for (int i = 0; i < N; i++) {
		worst[1] = fmax(worst[1], fabs(lightpath_gain(&generic, s->P[i], s->W[i], s->K[i]) / s->truth[i] - 1));
		worst[2] = fmax(worst[2], fabs((double)s->gain[i] / s->truth[i] - 1));
	}
	for (int k = 0; k < 3; k++)
		bench_row("caustic", names[k], "0 B", bench_time_each(t[k], TIMED), "place", worst[k], "", "gain against finite differences, worst relative");
	bench_goal("caustic: double, against finite differences", "<= 1e-4 relative, no storage", worst[1], "", worst[1] <= 1e-4);
	bench_goal("caustic: float, against finite differences", "<= 1e-4 relative, no storage", worst[2], "", worst[2] <= 1e-4);
}

struct patch {
	double sum, sum2;  // of the photons' weights and of their squares
};

/* Photons of light from w through the whole cornea, counted on a grid of CELLS² patches of the iris plane, +-5 mm. */
static void photons(struct patch patch[CELLS * CELLS], const double w[3], double z, long n)
{
	struct rng rng = { 9 };
	double rim = generic.rim, down[3] = { -w[0], -w[1], -w[2] };
	for (long i = 0; i < n; i++) {
		double x = rng_range(&rng, -rim, rim), y = rng_range(&rng, -rim, rim), N_[3], in[3];
		if (hypot(x, y) > rim)
			continue;
		double at[3] = { x, y, cornea_depth(&generic, hypot(x, y)) };
		cornea_normal(N_, &generic, at);
		double cos_i = vec_dot(w, N_);
		if (cos_i <= 0 || !refract(in, down, N_, 1, generic.n))
			continue;
		double t = (z - at[2]) / in[2];
		int u = (int)floor((at[0] + t * in[0] + 5) / 10 * CELLS), v = (int)floor((at[1] + t * in[1] + 5) / 10 * CELLS);
		if (u < 0 || v < 0 || u >= CELLS || v >= CELLS)
			continue;
		double weight = cos_i / -N_[2] * fresnel_transmittance(cos_i, 1, generic.n);
		patch[v * CELLS + u].sum += weight;
		patch[v * CELLS + u].sum2 += weight * weight;
	}
}

/* Mean gain over a patch; NAN where a part of it has no path inside the rim. */
static double expected(int u, int v, const double w[3], double z)
{
	enum { SUB = 6 };
	double sum = 0;
	for (int k = 0; k < SUB * SUB; k++) {
		double P[3] = { (u + (k % SUB + 0.5) / SUB) * 10 / CELLS - 5, (v + (k / SUB + 0.5) / SUB) * 10 / CELLS - 5, z }, K[3];
		if (lightpath_solve_directional(K, &generic, P, w) != LIGHTPATH_OK)
			return NAN;
		sum += lightpath_gain(&generic, P, w, K) / (SUB * SUB);
	}
	return sum;
}

static void against_photons(void)
{
	const double degrees[] = { 0, 45, 75 };
	long n = bench_quick() ? 1000000 : 8000000;
	double most = 0;
	for (int a = 0; a < COUNT(degrees); a++) {
		struct patch patch[CELLS * CELLS] = { 0 };
		double angle = degrees[a] * M_PI / 180, w[3] = { sin(angle), 0, -cos(angle) }, chi2 = 0, cells = 0, off = 0;
		double area = 10.0 / CELLS * 10.0 / CELLS, each = 4 * generic.rim * generic.rim / (double)n;
		photons(patch, w, 3.3, n);
		for (int i = 0; i < CELLS * CELLS; i++) {
			double e = expected(i % CELLS, i / CELLS, w, 3.3), d = patch[i].sum * each / area - e;
			if (!isfinite(e))
				continue;
			double sigma = sqrt(patch[i].sum2) * each / area;
			chi2 += d * d / (sigma * sigma);
			off += fabs(d) / e;
			cells++;
		}
		char setting[80];
		snprintf(setting, sizeof setting, "light %g degrees off the axis, %.0f patches, %ld photons", degrees[a], cells, n);
		bench_row("caustic against photons", "closed form", setting, (struct bench_time){ NAN, NAN, NAN }, "place", 100 * off / cells, "%", "irradiance of a patch, mean");
		bench_row("caustic against photons", "closed form", setting, (struct bench_time){ NAN, NAN, NAN }, "place", sqrt(chi2 / cells), "sigma", "of the photons' noise, root mean square");
		most = fmax(most, sqrt(chi2 / cells));
	}
	// Of 400 patches the root mean square is 1 +- 0.035 where nothing but noise is left.
	bench_goal("caustic against photons by brute force", "within their noise: rms <= 1.1 sigma", most, "sigma", most <= 1.1);
}

int main(int argc, char **argv)
{
	bench_open("caustic", argc, argv);
	s = mem_new(1, sizeof *s);
	draw();
	against_differences();
	against_photons();
	free(s);
	return bench_close();
}
