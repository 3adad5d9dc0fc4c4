/* What the stage `track` is put together from, against closed forms: the path of a head, a margin as a chain of points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/chol.h"
#include "math/rng.h"
#include "math/walk.h"
#include "track/clip/film.h"
#include "track/lid/line.h"
#include "tests/lib/unit.h"

enum { N = 30 };

/* The normal equations of the same path, solved as a full matrix. */
static void walk_is_least_squares(void **state)
{
	(void)state;
	struct rng rng = { 3 };
	double x[N], sigma[N], room[N], H[N][N] = { { 0 } }, b[N], step = 0.2;
	for (int i = 0; i < N; i++) {
		x[i] = sin(0.3 * i) + 0.1 * rng_uniform(&rng);
		sigma[i] = i % 7 == 3 ? 1e4 : 0.05 + 0.3 * rng_uniform(&rng);
		H[i][i] += 1 / (sigma[i] * sigma[i]);
		b[i] = x[i] / (sigma[i] * sigma[i]);
		for (int k = i - 1; i && k <= i; k++)
			for (int j = i - 1; j <= i; j++)
				H[k][j] += (k == j ? 1 : -1) / (step * step);
	}
	walk_smooth(N, x, sigma, step, room);
	assert_true(chol_solve(N, N, &H[0][0], b));
	for (int i = 0; i < N; i++)
		NEAR(x[i], b[i], 1e-9);
}

/* One sure measurement among none: the path stays there. Of two, a straight line runs from one to the other. */
static void walk_between(void **state)
{
	(void)state;
	double x[N], sigma[N], room[N];
	for (int i = 0; i < N; i++) {
		x[i] = i == 5 ? 2 : i == 25 ? 6 : 99;
		sigma[i] = i == 5 || i == 25 ? 1e-6 : 1e9;
	}
	walk_smooth(N, x, sigma, 1, room);
	for (int i = 0; i < N; i++)
		NEAR(x[i], i < 5 ? 2 : i > 25 ? 6 : 2 + 0.2 * (i - 5), 1e-6);
	double one = 3, s = 1;
	walk_smooth(1, &one, &s, 1, room);
	NEAR(one, 3, 0);
}

/* A path that keeps its speed, against its normal equations solved densely. */
static void glide_is_least_squares(void **state)
{
	(void)state;
	static const double second[3] = { 1, -2, 1 };
	struct rng rng = { 4 };
	double x[N], sigma[N], room[2 * N], H[N][N] = { { 0 } }, b[N], bend = 0.1;
	for (int i = 0; i < N; i++) {
		x[i] = sin(0.3 * i) + 0.1 * rng_uniform(&rng);
		sigma[i] = i % 7 == 3 ? 1e3 : 0.05 + 0.3 * rng_uniform(&rng);
		H[i][i] += 1 / (sigma[i] * sigma[i]);
		b[i] = x[i] / (sigma[i] * sigma[i]);
		for (int k = 0; i + 2 < N && k < 9; k++)
			H[i + k / 3][i + k % 3] += second[k / 3] * second[k % 3] / (bend * bend);
	}
	walk_glide(N, x, sigma, bend, room);
	assert_true(chol_solve(N, N, &H[0][0], b));
	for (int i = 0; i < N; i++)
		NEAR(x[i], b[i], 1e-8);
}

/* A line with a gap of twelve elements that say nonsense: the line goes on through it. A turn in the gap: a cubic, not a chord. */
static void glide_over_gap(void **state)
{
	(void)state;
	double line[N], turn[N], sigma[N], room[2 * N];
	for (int i = 0; i < N; i++) {
		bool gap = i >= 12 && i < 24;
		line[i] = gap ? 50 : 0.3 * i;
		turn[i] = gap ? -50 : fabs(i - 17.5);
		sigma[i] = gap ? 1e6 : 1e-3;
	}
	walk_glide(N, line, sigma, 0.1, room);
	walk_glide(N, turn, sigma, 0.1, room);
	for (int i = 0; i < N; i++)
		NEAR(line[i], 0.3 * i, 1e-3);
	// the steps into and out of it have slopes of -1 and 1, their middles are 14 apart and at height 7: the cubic is lower than the chord by 14 / 4
	NEAR(turn[17], 7 - 14.0 / 4, 0.01);
	double one[2] = { 3, 4 }, s[2] = { 1, 1 };
	walk_glide(2, one, s, 1, room);
	NEAR(one[0], 3, 0);
	NEAR(one[1], 4, 0);
}

/* A parabola between (0, 0) and (10, 0). */
static struct line bow(int n)
{
	struct line line = { 0 };
	for (int i = 0; i < n; i++) {
		double x = 10.0 * i / (n - 1);
		line_add(&line, (double[]){ x, 0.2 * x * (10 - x) });
	}
	return line;
}

static void line_places(void **state)
{
	(void)state;
	const double ends[2][2] = { { 0, 0 }, { 10, 0 } };
	struct line line = bow(101);
	double p[2];
	NEAR(line_along((double[]){ 4, 7 }, ends[0], ends[1]), 0.4, 1e-12);
	assert_true(line_passes(p, &line, 0.25, ends));
	NEAR(p[0], 2.5, 1e-9);
	NEAR(p[1], 0.2 * 2.5 * 7.5, 1e-9);
	assert_false(line_passes(p, &line, 1.2, ends));
	// above the top the nearest place is the top; the chain's chords lie 0.2 * 0.05^2 below it
	line_nearest(p, &line, (double[]){ 5, 9 });
	NEAR(p[0], 5, 1e-9);
	NEAR(p[1], 5, 1e-3);
	line_nearest(p, &line, (double[]){ -3, -1 });
	NEAR(hypot(p[0], p[1]), 0, 1e-9);
}

static void line_spreads_evenly(void **state)
{
	(void)state;
	enum { POINTS = 17 };
	struct line line = bow(LINE);
	double out[POINTS][2], least = INFINITY, most = 0;
	line_spread(out, POINTS, &line);
	for (int i = 0; i + 1 < POINTS; i++) {
		double d = hypot(out[i + 1][0] - out[i][0], out[i + 1][1] - out[i][1]);
		least = fmin(least, d);
		most = fmax(most, d);
	}
	// chords of equal arcs differ by their curvature: (length / radius)^2 / 24, radius 2.5 at the top
	assert_true(most / least < 1 + 1.0 / 24);
	NEAR(hypot(out[POINTS - 1][0] - 10, out[POINTS - 1][1]), 0, 1e-9);
	line_add(&line, (double[]){ 99, 99 });
	assert_int_equal(line.n, LINE);
}

/* A small picture's pixels are the whole means of the large one's, white ones too, whatever number of pixels it takes together. */
static void film_is_means(void **state)
{
	(void)state;
	enum { W = 97, H = 61 };
	struct rng rng = { 5 };
	uint8_t luma[H][W];
	const struct video_frame frame = { .width = W, .height = H, .luma = &luma[0][0], .luma_stride = W };
	for (int s = 1; s < 12; s++) {
		struct film film = { .x0 = 3, .y0 = 2, .step = s, .width = (W - 3) / s, .height = (H - 2) / s, .every = 1 };
		for (int i = 0; i < W * H; i++)
			luma[i / W][i % W] = i % W < W / 3 ? 255 : (uint8_t)(256 * rng_uniform(&rng));
		film_add(&film, &frame);
		assert_int_equal(film.n, 1);
		for (int y = 0; y < film.height; y++)
			for (int x = 0; x < film.width; x++) {
				int sum = 0;
				for (int i = 0; i < s * s; i++)
					sum += luma[2 + y * s + i / s][3 + x * s + i % s];
				assert_int_equal(film.px[0][y * film.width + x], sum / (s * s));
			}
		free(film.px[0]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(walk_is_least_squares),
		cmocka_unit_test(walk_between),
		cmocka_unit_test(glide_is_least_squares),
		cmocka_unit_test(glide_over_gap),
		cmocka_unit_test(line_places),
		cmocka_unit_test(line_spreads_evenly),
		cmocka_unit_test(film_is_means),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
