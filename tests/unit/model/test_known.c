/* The gazes at which lids are known: inside nothing changes, outside the nearest one drives them, and a little more. */
#include "math/rng.h"
#include "model/known.h"
#include "tests/lib/unit.h"

enum { FRAMES = 200, STRIDE = 11 };

/* Frames whose left eye looks into an ellipse of 20 by 10 degrees about (3, -2); the right eye is not measured. */
static struct known ellipse(double beyond)
{
	static double g[FRAMES][STRIDE];
	struct known k;
	for (int i = 0; i < FRAMES; i++) {
		double a = 2 * M_PI * i / FRAMES;
		for (int c = 0; c < STRIDE; c++)
			g[i][c] = NAN;
		g[i][0] = 3 + 20 * cos(a);
		g[i][1] = -2 + 10 * sin(a);
		g[i][2] = i % 7 ? 1.5 * sin(a) : NAN;
	}
	g[17][0] = NAN;
	known_of(&k, FRAMES, g[0], STRIDE, beyond);
	return k;
}

static void inside_nothing_changes(void **state)
{
	(void)state;
	const struct known k = ellipse(0.3);
	struct rng rng = { 5 };
	for (int i = 0; i < 1000; i++) {
		double r = 0.9 * rng_uniform(&rng), a = rng_range(&rng, 0, 2 * M_PI), gaze[3] = { 3 + 20 * r * cos(a), -2 + 10 * r * sin(a), rng_range(&rng, -1.4, 1.4) };
		double was[3] = { gaze[0], gaze[1], gaze[2] };
		known_hold(gaze, &k, i % 2);  // the right eye's are the left's
		for (int c = 0; c < 3; c++)
			assert_true(gaze[c] == was[c]);
	}
}

static void outside_the_nearest_and_a_little_more(void **state)
{
	(void)state;
	const struct known hard = ellipse(0), soft = ellipse(0.3);
	double gaze[3] = { 63, -2, 9 };
	known_hold(gaze, &hard, 0);
	NEAR(gaze[0], 23, 1e-12);  // a frame looked exactly there
	NEAR(gaze[1], -2, 1e-12);
	NEAR(gaze[2], 1.5, 0.01);
	double more[3] = { 63, -2, 9 };
	known_hold(more, &soft, 0);
	NEAR(more[0], 23 + 0.3 * 20 * tanh(40 / 6.0), 1e-9);
	NEAR(more[2], 1.3 * gaze[2], 1e-3);
	double down[3] = { 3, -52, 0 };
	known_hold(down, &soft, 0);
	NEAR(down[1], -12 - 3, 1e-9);
}

/* No step and no kink where gaze leaves the hull: neighbours stay neighbours. */
static void continuous(void **state)
{
	(void)state;
	const struct known k = ellipse(0.3);
	struct rng rng = { 6 };
	for (int i = 0; i < 2000; i++) {
		double a[3] = { rng_range(&rng, -60, 60), rng_range(&rng, -60, 60), 0 }, b[3] = { a[0] + 1e-4, a[1] - 1e-4, 0 };
		known_hold(a, &k, 0);
		known_hold(b, &k, 0);
		assert_true(hypot(a[0] - b[0], a[1] - b[1]) < 4e-4);
	}
	double out[3] = { 23 + 1e-3, -2, 0 };
	known_hold(out, &k, 0);
	NEAR(out[0], 23 + 1e-3, 1e-9);
}

/* A clip of one saccade knows gazes on a line, one of a stare a point: off it nothing is made up. */
static void a_line_and_a_point(void **state)
{
	(void)state;
	double g[3][STRIDE] = { { 0 }, { -8, 4, 0, 0, 0, -6, 4 }, { -16, 8, 0, 0, 0, -14, 8 } };
	struct known k;
	known_of(&k, 3, g[0], STRIDE, 0.3);
	double aside[3] = { -25, 0, 0 }, back[3] = { 30, 0, 0 }, on[3] = { -8, 4, 0 };
	known_hold(aside, &k, 0);
	NEAR(aside[0], -16, 1e-9 + 2.7);
	assert_true(hypot(aside[0] + 16, aside[1] - 8) < 0.3 * 9);
	known_hold(back, &k, 0);
	assert_true(hypot(back[0], back[1]) < 0.3 * 9);
	known_hold(on, &k, 0);
	NEAR(on[0], -8, 1e-12);
	known_of(&k, 1, g[1], STRIDE, 0.3);
	double far[3] = { 40, 40, 3 };
	known_hold(far, &k, 1);
	NEAR(far[0], -6, 1e-12);
	NEAR(far[1], 4, 1e-12);
	NEAR(far[2], 0, 1e-12);
}

static void nothing_measured_nothing_held(void **state)
{
	(void)state;
	double g[STRIDE], gaze[3] = { 70, -80, 20 };
	struct known k;
	struct err err = { 0 };
	for (int c = 0; c < STRIDE; c++)
		g[c] = NAN;
	known_of(&k, 1, g, STRIDE, 0.3);
	known_hold(gaze, &k, 0);
	assert_true(gaze[0] == 70 && gaze[1] == -80 && gaze[2] == 20);
	assert_true(known_check(&k, "here", &err));
	k.corner[1][3][1] = NAN;
	assert_false(known_check(&k, "here", &err));
	ERR_HAS(err, "here: gazes known");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(inside_nothing_changes), cmocka_unit_test(outside_the_nearest_and_a_little_more), cmocka_unit_test(continuous),
		cmocka_unit_test(a_line_and_a_point),     cmocka_unit_test(nothing_measured_nothing_held),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
