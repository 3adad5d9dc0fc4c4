/* Where between the corners of its lids an iris lies: evidence that is painted. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/opening.h"
#include "tests/lib/unit.h"

enum { WIDE = 160, HIGH = 96 };

/* Sclera from left to right, a gap in it, skin about it; 2 px of the photograph each. */
static struct evidence painted(int left, int right, int gap)
{
	struct evidence e = { .width = WIDE, .height = HIGH, .scale = 2 };
	float *all = mem_new((size_t)EVIDENCE_CLASSES * WIDE * HIGH, sizeof *all);
	for (int c = 0; c < EVIDENCE_CLASSES; c++)
		e.plane[c] = all + (size_t)c * WIDE * HIGH;
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++) {
			const bool white = x >= left && x < right && abs(y - HIGH / 2) < 10 && (x < gap || x >= gap + 3);
			e.plane[white ? EVIDENCE_SCLERA : EVIDENCE_SKIN][y * WIDE + x] = 1;
		}
	return e;
}

static void corners_are_where_the_white_ends(void **state)
{
	(void)state;
	const struct ellipse limbus = { 160, 96, 40, 38, 0 };
	double reach[2];
	struct evidence e = painted(30, 140, 115);  // 60 and 280 px
	opening_reach(reach, &e, &limbus, 2 * WIDE);
	NEAR(reach[0], 2.5, 0.1);
	NEAR(reach[1], 3, 0.15);
	// a picture that ends before the corner does
	opening_reach(reach, &e, &limbus, 270);
	NEAR(reach[0], 2.5, 0.1);
	NEAR(reach[1], 0, 0);
	free(e.plane[0]);
	// none shows
	e = painted(0, 0, 0);
	opening_reach(reach, &e, &limbus, 2 * WIDE);
	assert_true(reach[0] > 0 && reach[0] < 1 && reach[1] == reach[0]);
	free(e.plane[0]);
}

static void nearer_to_the_right_is_turned_there(void **state)
{
	(void)state;
	const struct opening_conf conf = { .arm = 10, .sigma = 0.2, .misled = 0.05 };
	const double reach[2] = { 3, 2 };
	assert_true(opening_known(reach, &conf) && !opening_known((double[2]){ 3, 0 }, &conf) && !opening_known(reach, &(struct opening_conf){ .arm = 10 }));
	NEAR(opening_likelihood(reach, asin(0.3), 6, &conf), 1, 1e-12);
	assert_true(opening_likelihood(reach, 0.3, 6, &conf) > opening_likelihood(reach, -0.3, 6, &conf));
	NEAR(opening_likelihood(reach, -1.5, 6, &conf), 0.05, 1e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(corners_are_where_the_white_ends), cmocka_unit_test(nearer_to_the_right_is_turned_there) };
	return cmocka_run_group_tests(tests, 0, 0);
}
