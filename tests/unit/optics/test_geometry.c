/* The iris behind its cornea stands where an independent path tracer sees it: map of iris points, and the photograph itself. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/score/registered.h"
#include "tests/lib/unit.h"

/* What the project set itself, px of the photograph; of 95 % of the places. */
static const double reach_px = 0.3;

static void judge(const struct truth *t, const char *by, int shading, struct registered *r)
{
	double median = stats_quantile(r->n, r->px, 0.5), far = stats_quantile(r->n, r->px, 0.95);
	print_message("%s, %s, shading %d: %d places, median %.4f, 95 %% %.4f px, mean %.4f %.4f\n", t->name, by, shading, r->n, median, far, r->mean[0], r->mean[1]);
	assert_true(r->n > 25);
	assert_true(far <= reach_px);
	registered_free(r);
}

static void capture(const char *name, bool map, int shading)
{
	const char *root = bench_data("eyes");
	if (SANITISED)
		skip();  // minutes, of code that test_render's sanitised run goes through
	if (!root) {
		print_message("the rendered captures are not there\n");
		skip();
	}
	char *dir = mem_printf("%s/%s", root, name);
	struct truth t;
	struct registered r;
	struct err err = { 0 };
	if (!truth_load(&t, dir, &err))
		fail_msg("%s", err.msg);
	if (map) {
		if (!registered_map(&r, &t, dir, &err))
			fail_msg("%s", err.msg);
		judge(&t, "map", shading, &r);
	} else {
		if (!registered_photo(&r, &t, dir, shading, &err))
			fail_msg("%s", err.msg);
		judge(&t, "photograph", shading, &r);
	}
	free(dir);
}

static void points_from_the_side(void **state)
{
	(void)state;
	capture("G05_blue_40", true, SCENE_RAYS);
}

static void photograph(const char *name, int shading)
{
	capture(name, false, shading);
}

static void photograph_of_a_checkerboard(void **state)
{
	(void)state;
	photograph("C01_checker_00", SCENE_TEXELS);
}

static void photograph_through_two_surfaces(void **state)
{
	(void)state;
	photograph("G10_green_25_2surf", SCENE_RAYS);
}

/* The test sees what it is to see: an iris 0.1 mm too deep is found in the wrong place. */
static void wrong_depth_is_seen(void **state)
{
	(void)state;
	const char *root = bench_data("eyes");
	if (!root || SANITISED)
		skip();
	char *dir = mem_printf("%s/G05_blue_40", root);
	struct truth t;
	struct registered r;
	struct err err = { 0 };
	if (!truth_load(&t, dir, &err))
		fail_msg("%s", err.msg);
	t.eye.iris_depth += 0.1;
	if (!registered_map(&r, &t, dir, &err))
		fail_msg("%s", err.msg);
	double median = stats_median(r.n, r.px);
	print_message("0.1 mm too deep: %.2f px\n", median);
	assert_true(median > 1);
	registered_free(&r);
	free(dir);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_from_the_side),
		cmocka_unit_test(photograph_of_a_checkerboard),
		cmocka_unit_test(photograph_through_two_surfaces),
		cmocka_unit_test(wrong_depth_is_seen),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
