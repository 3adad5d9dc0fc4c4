/* Openings that taper to their outer corner, and such as do not. Truth: margins drawn from closed forms. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "track/clip/tapers.h"

enum { POINTS = 20, FRAMES = 4 };

/* Margins between corners 100 px apart, 30 px high; of the outer half of the upper one so much of what it falls by is missing. */
static void draw(struct eye_state *s, double leak)
{
	*s = (struct eye_state){ .lid_points = POINTS, .openness = 1, .blink = BLINK_OPEN, .lid_confidence = { 0.8, 0.7 } };
	for (int i = 0; i < POINTS; i++) {
		const double u = (double)i / (POINTS - 1), bow = 4 * u * (1 - u), kept = i == POINTS - 1 ? 0 : u > 0.5 ? bow + leak * (1 - bow) : bow;
		for (int lid = 0; lid < LIDS; lid++) {
			s->lid[lid][i][0] = 300 + 100 * u;
			s->lid[lid][i][1] = 200 + (lid == LID_LOWER ? 12 * bow : -18 * kept);
		}
	}
}

/* Margins stand apart at 0.92 of the width by 0.29 of their height where nothing is missing, by 0.4 where a quarter of what it falls by is: both are openings. */
static void test_stays(void **state)
{
	(void)state;
	struct track_subject subject = { .assumed = true };
	for (int k = 0; k < 2; k++) {
		struct eye_state eyes[1][SIDES];
		struct track_result r = { .n = 1, .has_eyes = true };
		r.eyes.frames = 1;
		r.eyes.state = eyes;
		draw(&eyes[0][SIDE_LEFT], 0.25 * k);
		draw(&eyes[0][SIDE_RIGHT], 0);
		// not known at one corner: nothing to tell it by
		eyes[0][SIDE_RIGHT].lid[LID_LOWER][0][0] = NAN;
		track_tapers(&r, &subject);
		assert_true(isfinite(eyes[0][SIDE_LEFT].lid[LID_UPPER][1][1]) && eyes[0][SIDE_LEFT].lid_confidence[LID_UPPER] > 0 && eyes[0][SIDE_RIGHT].lid_confidence[LID_UPPER] > 0);
	}
}

/* One that lies on the lid is forgotten, in that eye alone; one of a shut or half shut eye says nothing, and with a mesh nothing changes. */
static void test_forgotten(void **state)
{
	(void)state;
	for (int mesh = 0; mesh < 2; mesh++) {
		struct track_subject subject = { .assumed = !mesh };
		struct track_result r = { .n = FRAMES, .has_eyes = true };
		r.eyes.frames = FRAMES;
		r.eyes.state = mem_new(FRAMES, sizeof *r.eyes.state);
		for (int f = 0; f < FRAMES; f++) {
			draw(&r.eyes.state[f][SIDE_LEFT], f ? 1 : 0);
			draw(&r.eyes.state[f][SIDE_RIGHT], 0);
		}
		r.eyes.state[2][SIDE_LEFT].openness = 0.3;
		r.eyes.state[3][SIDE_LEFT].blink = BLINK_CLOSING;
		track_tapers(&r, &subject);
		for (int f = 0; f < FRAMES; f++) {
			const struct eye_state *s = r.eyes.state[f];
			const bool gone = f == 1 && !mesh;
			assert_true(isnan(s[SIDE_LEFT].lid[LID_UPPER][3][1]) == gone && isnan(s[SIDE_LEFT].lid[LID_LOWER][POINTS - 1][0]) == gone);
			assert_true((s[SIDE_LEFT].lid_confidence[LID_UPPER] > 0) == !gone);
			assert_true(isfinite(s[SIDE_RIGHT].lid[LID_UPPER][3][1]) && s[SIDE_RIGHT].lid_confidence[LID_LOWER] > 0);
		}
		free(r.eyes.state);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_stays), cmocka_unit_test(test_forgotten) };
	return cmocka_run_group_tests(tests, 0, 0);
}
