/* Margins drawn to evidence of the opening. Truth: margins from a closed form; evidence that ends within them by what it is said to. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "track/clip/margin_draw.h"

enum { POINTS = 20, FRAMES = 9, EVERY = 2 };
static const double radius = 40, wide = 160;

static const struct track_conf conf = {
	.canthi = { .beyond = { 0.06, -0.04, 0.1, 0.02 }, .outline_beyond = 0.03, .outline_sigma = 0.03, .most = 0.3 },
	.lids = { .every = EVERY, .found_px = 2, .corner_sigma = { 1, 0.06, 0.06, 0.045 }, .ends_sigma = { 0.03, 0.03 }, .ends_beyond = { 0.03, 0.03 } },
};

/* Height of a margin at the share u of the way between corners, px. */
static double height(int lid, double u)
{
	return lid == LID_LOWER ? 25 * 4 * u * (1 - u) : -40 * 4 * u * (1 - u);
}

/* A left eye (inner corner on the left) or a right one, its lower margin `off` px too low between its corners, its corners where they are. */
static void found(struct eye_state *s, int side, double off)
{
	*s = (struct eye_state){ .lid_points = POINTS };
	for (int i = 0; i < POINTS; i++)
		for (int lid = 0; lid < LIDS; lid++) {
			const double u = (double)i / (POINTS - 1), far = lid == LID_LOWER && i && i < POINTS - 1 ? off : 0;
			s->lid[lid][i][0] = 300 + (side == SIDE_LEFT ? wide * u : -wide * u);
			s->lid[lid][i][1] = 200 + height(lid, u) + far;
		}
}

static void seen_of(struct margin_seen *s, int side)
{
	*s = (struct margin_seen){ .known = true, .ends = true, .radius = (float)radius, .scale = (float)(radius / 20), .width = MARGIN_SEEN_WIDE, .height = MARGIN_SEEN_HIGH };
	s->x0 = (float)(300 + (side == SIDE_LEFT ? 0.5 : -0.5) * wide - 0.5 * MARGIN_SEEN_WIDE * radius / 20);
	s->y0 = (float)(200 - 0.5 * MARGIN_SEEN_HIGH * radius / 20);
	for (int i = 0; i < s->width * s->height; i++) {
		const double x = (double)s->x0 + (i % s->width + 0.5) * radius / 20, y = (double)s->y0 + (i / s->width + 0.5) * radius / 20, u = fabs(x - 300) / wide;
		const bool is = (x > 300) == (side == SIDE_LEFT) && u < 1;
		const double in = fmin(y - 200 - height(LID_UPPER, u), 200 + height(LID_LOWER, u) - y) - 0.03 * radius;
		s->eye[i] = (uint8_t)(255 * (is ? fmin(1, fmax(0, 0.5 + 0.5 * in / (radius / 20))) : 0));
	}
	for (int c = 0; c < 2; c++) {
		const double inward = (side == SIDE_LEFT ? 1 : -1) * (c ? -1 : 1);
		s->corner[c][0] = (float)(300 + (c ? (side == SIDE_LEFT ? wide : -wide) : 0) + inward * conf.canthi.beyond[2 * c] * radius);
		s->corner[c][1] = (float)(200 - conf.canthi.beyond[2 * c + 1] * radius);
	}
}

/* A margin that was followed 2 px off is drawn to the evidence by its share of the variances, in the frames between those looked at as well; one that lies right, and the corners, stay. */
static void test_drawn(void **state)
{
	(void)state;
	const double off = 2, share = 0.05 * 0.05 / (0.05 * 0.05 + 0.03 * 0.03);
	struct track_result r = { .n = FRAMES, .has_eyes = true };
	struct margin_seen(*seen)[SIDES] = mem_new(FRAMES / EVERY + 1, sizeof *seen);
	r.eyes.state = mem_new(FRAMES, sizeof *r.eyes.state);
	for (int f = 0; f < FRAMES; f++)
		for (int e = 0; e < SIDES; e++) {
			found(&r.eyes.state[f][e], e, off);
			if (f % EVERY == 0)
				seen_of(&seen[f / EVERY][e], e);
		}
	r.eyes.state[3][SIDE_LEFT].lid[LID_UPPER][0][0] = NAN;
	margin_draw(&r, (const struct margin_seen(*)[SIDES])seen, 60, &conf);
	for (int f = 0; f < FRAMES; f++)
		for (int e = 0; e < SIDES; e++) {
			const struct eye_state *s = &r.eyes.state[f][e];
			const double left = f == 3 && e == SIDE_LEFT ? off : (1 - share) * off;
			for (int i = 4; i < POINTS - 4; i++) {
				const double u = fabs(s->lid[LID_LOWER][i][0] - 300) / wide, v = fabs(s->lid[LID_UPPER][i][0] - 300) / wide;
				assert_float_equal(s->lid[LID_LOWER][i][1] - 200 - height(LID_LOWER, u), left, 0.3);
				assert_float_equal(s->lid[LID_UPPER][i][1] - 200 - height(LID_UPPER, v), 0, 0.3);
			}
			for (int c = 0; c < 2 && left < off; c++) {
				const int i = c ? POINTS - 1 : 0;
				assert_float_equal(fabs(s->lid[LID_UPPER][i][0] - 300), c ? wide : 0, 1);
				assert_float_equal(s->lid[LID_UPPER][i][1], 200, 1);
				assert_true(s->lid[LID_UPPER][i][0] == s->lid[LID_LOWER][i][0] && s->lid[LID_UPPER][i][1] == s->lid[LID_LOWER][i][1]);
			}
		}
	free(seen);
	free(r.eyes.state);
}

/* Of two edges the nearer one; where no eye ends within reach there is none. */
static void test_edge(void **state)
{
	(void)state;
	struct margin_seen *s = mem_new(1, sizeof *s);
	*s = (struct margin_seen){ .known = true, .radius = 20, .scale = 1, .width = 100, .height = 80 };
	for (int i = 0; i < s->width * s->height; i++)
		s->eye[i] = i / s->width < 30 || (i / s->width >= 40 && i / s->width < 60) ? 255 : 0;
	const double down[2] = { 0, 1 }, up[2] = { 0, -1 };
	assert_float_equal(margin_seen_edge(s, (double[2]){ 50, 32 }, down, 8), -2, 0.1);
	assert_float_equal(margin_seen_edge(s, (double[2]){ 50, 57 }, down, 8), 3, 0.1);
	assert_float_equal(margin_seen_edge(s, (double[2]){ 50, 42 }, up, 8), 2, 0.1);
	assert_true(isnan(margin_seen_edge(s, (double[2]){ 50, 50 }, down, 8)));
	free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_drawn), cmocka_unit_test(test_edge) };
	return cmocka_run_group_tests(tests, 0, 0);
}
