/* How much of the iris lower lids cover, against the segment of a circle in closed form. */
#include "model/model.h"
#include "model/own_low.h"
#include "tests/lib/unit.h"

enum { POINTS = 12 };
static const double focal = 6000, away = 600, radius = 12, limbus = 5.8;

/* A person who looks into the camera, whose lower margins stay straight, `below` radii of the iris below its middle. */
static void person(struct skin_model *m, double below)
{
	*m = (struct skin_model){ .n_points = POINTS, .camera = { .width = 640, .height = 480, .focal_px = focal, .center_px = { 320, 240 },
		.cam_from_head = { { 1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, -1, away }, { 0, 0, 0, 1 } } } };
	skin_model_alloc(m);
	const double front = away - sqrt(radius * radius - limbus * limbus);
	for (int s = 0; s < 2; s++) {
		m->eyes.center[s][0] = s ? -30 : 30;
		m->eyes.center[s][1] = m->eyes.center[s][2] = 0;
		m->eyes.radius[s] = radius;
		m->eyes.limbus[s] = limbus;
		for (int i = 0; i < POINTS; i++) {
			double *p = m->l0 + 2 * ((2 * s + 1) * POINTS + i);
			p[0] = 320 + focal / away * ((s ? -30 : 30) + 30.0 * (2.0 * i / (POINTS - 1) - 1));
			p[1] = 240 + below * limbus * focal / front;
		}
	}
}

static double segment(double q)
{
	return q >= 1 ? 0 : q <= -1 ? 1 : (acos(q) - q * sqrt(1 - q * q)) / M_PI;
}

static void a_segment(void **state)
{
	(void)state;
	for (int k = -2; k <= 6; k++) {
		struct skin_model m;
		const double below = 0.2 * k, plane = sqrt(radius * radius - limbus * limbus);
		person(&m, below);
		const struct own_low low = own_low_of(&m);
		for (int s = 0; s < 2; s++)
			for (int v = 0; v <= 25; v += 5) {
				// The iris sinks, foreshortened, the margin stays.
				const double q = (below * limbus * (away - plane * cos(v * M_PI / 180)) / (away - plane) - plane * sin(v * M_PI / 180)) / (limbus * cos(v * M_PI / 180));
				NEAR(own_low_at(&low, s, 0, -v), segment(q), 0.015);
			}
		assert_true(own_low_at(&low, 0, 0, 10) == own_low_at(&low, 0, 0, 0) && own_low_at(&low, 0, 0, -90) == own_low_at(&low, 0, 0, -25));
		skin_model_free(&m);
	}
}

/* Of eyes or lids that are not known nothing is asked. */
static void unknown(void **state)
{
	(void)state;
	struct skin_model m;
	person(&m, 0.5);
	m.l0[2 * POINTS] = NAN;
	const struct own_low lids = own_low_of(&m);
	assert_true(own_low_at(&lids, 0, 0, -10) == 1 && own_low_at(&lids, 1, 0, -10) < 0.9);
	m.eyes = skin_eyes_unknown();
	const struct own_low eyes = own_low_of(&m);
	assert_true(own_low_at(&eyes, 1, 3, -12) == 1);
	skin_model_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(a_segment), cmocka_unit_test(unknown) };
	return cmocka_run_group_tests(tests, 0, 0);
}
