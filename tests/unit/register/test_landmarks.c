/* Landmarks of a configuration: pairs by name, names that the subject lacks, rows out of range, lists that are none. */
#include "tests/lib/unit.h"

#include "register/landmarks.h"

enum { TARGET = 50, SUBJECT = 40 };

static bool pair(struct nricp_landmarks *out, struct err *err, const char *text)
{
	struct opt_each list = { .name = "hero", .text = text }, rows[] = { { .name = "left_inner_canthus", .value = { 7 } },
		                                                                { .name = "right_inner_canthus", .value = { 11 } },
		                                                                { .name = "far", .value = { SUBJECT } } };
	struct opt_each_list lists = { &list, 1 }, subject = { rows, 3 };
	return landmarks_pair(out, "hero", &lists, TARGET, SUBJECT, &subject, err);
}

static void test_pairs(void **state)
{
	(void)state;
	struct nricp_landmarks l;
	struct err err = { 0 };
	assert_true(pair(&l, &err, "right_inner_canthus 3, chin 4,left_inner_canthus 49"));
	assert_int_equal(l.n, 2);  // the subject has no chin
	assert_true(l.moving[0] == 3 && l.fixed[0] == 11 && l.moving[1] == 49 && l.fixed[1] == 7);
	free((void *)l.moving);
	assert_true(landmarks_pair(&l, "hero", &(struct opt_each_list){ 0 }, TARGET, SUBJECT, &(struct opt_each_list){ 0 }, &err));
	assert_true(l.n == 0 && !l.moving);
}

static void test_faults(void **state)
{
	(void)state;
	static const char *const bad[] = { "left_inner_canthus", "left_inner_canthus 3 4", "left_inner_canthus 50", "left_inner_canthus -1",
		                               "far 3", "chin 3; jaw 4" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct nricp_landmarks l;
		struct err err = { 0 };
		if (pair(&l, &err, bad[i]))
			fail_msg("\"%s\" is taken", bad[i]);
		ERR_HAS(err, "capture.conf: ");
		free((void *)l.moving);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_pairs), cmocka_unit_test(test_faults) };
	return cmocka_run_group_tests(tests, 0, 0);
}
