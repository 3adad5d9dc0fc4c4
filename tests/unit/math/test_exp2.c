/* Powers in vector code against the C library's. */
#include "tests/lib/unit.h"

#include "math/exp2.h"

static void powers_of_two_to_four_digits(void **state)
{
	(void)state;
	for (float t = -119.9f; t < 120; t += 0.0371f) {
		const float want = exp2f(t);
		assert_true(fabsf(exp2_quick(t) - want) < 1.1e-4f * want);
	}
}

static void powers_of_e_to_eleven_digits(void **state)
{
	(void)state;
	double worst = 0;
	for (double x = -690; x < 690; x += 0.00731) {
		const double want = exp(x);
		worst = fmax(worst, fabs(exp_quick(x) / want - 1));
	}
	assert_true(worst < 1e-11);
	assert_true(exp_quick(0) == 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(powers_of_two_to_four_digits),
		cmocka_unit_test(powers_of_e_to_eleven_digits),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
