/* Odds to any tolerance: between the tolerances that are told, and the network that tells them. */
#include "limbus/odds_net.h"
#include "tests/lib/unit.h"

static void between_tolerances_the_logarithm_is_straight(void **state)
{
	(void)state;
	double curve[ODDS_CURVE];
	for (int i = 0; i < ODDS_CURVE; i++)
		curve[i] = 3 + 2 * log(odds_tolerance[i]);
	NEAR(odds_log(curve, 0.02), 3 + 2 * log(0.02), 1e-12);
	NEAR(odds_log(curve, 0.0177), 3 + 2 * log(0.0177), 1e-12);
	NEAR(odds_log(curve, 0.05), 3 + 2 * log(0.05), 1e-12);
	NEAR(odds_log(curve, 1e-4), curve[0], 0);
	NEAR(odds_log(curve, 0.5), curve[ODDS_CURVE - 1], 0);
}

/* Odds of one sigma, erf(1 / sqrt 2), where the tolerance is exp((log odds - 3) / 2) / 10. */
static void an_error_wider_than_its_sigma(void **state)
{
	(void)state;
	double curve[ODDS_CURVE];
	for (int i = 0; i < ODDS_CURVE; i++)
		curve[i] = 3 + 2 * log(10 * odds_tolerance[i]);
	const double chance = erf(1 / sqrt(2)), log_odds = log(chance / (1 - chance));
	NEAR(odds_wider(0.01, curve), exp((log_odds - 3) / 2) * 10, 1e-3);
	NEAR(odds_wider(0.1, curve), 1, 0);
	// off by less than can be told
	for (int i = 0; i < ODDS_CURVE; i++)
		curve[i] = i + 1;
	NEAR(odds_wider(1e-6, curve), 1, 0);
}

/* A clear eye, with traits that drawn eyes have which are clear, and a doubtful one, of which the strip tells another ellipse. */
static void the_network_that_is_shipped(void **state)
{
	(void)state;
	struct odds_net *net;
	struct err err = { 0 };
	double clear[ODDS_TRAITS] = { [ODDS_ONE] = 1, [ODDS_SCATTER] = -6, [ODDS_COVERAGE] = 0.8, [ODDS_SIGMA] = -6, [ODDS_CONTRAST] = 0, [ODDS_BLUR] = 0.01,
		[ODDS_SCLERA_OUTSIDE] = 0.95, [ODDS_IRIS_INSIDE] = 0.95, [ODDS_SCLERA_INSIDE] = 0.02, [ODDS_IRIS_OUTSIDE] = 0.02, [ODDS_EYE] = 0.95, [ODDS_AROUND] = 0.7,
		[ODDS_BEHIND] = 0.1, [ODDS_OFF] = 0.01, [ODDS_PUPIL] = 1, [ODDS_ROUND] = -0.02, [ODDS_IRIS_EVEN] = -3, [ODDS_SCLERA_EVEN] = -2.6,
		[ODDS_STRIP_SEEN] = 0.8, [ODDS_STRIP_ON] = 0.98, [ODDS_STRIP_WORTH] = 50, [ODDS_STRIP_BEHIND] = 0.1, [ODDS_STRIP_SCATTER] = -5.5,
		[ODDS_STRIP_APART] = -5.5, [ODDS_STRIP_SIGMA] = -5.1, [ODDS_STRIP_MOVED] = -5.5, [ODDS_STRIP_BLIND] = -5, [ODDS_STRIP_END] = 0.8,
		[ODDS_SIZE] = 4.6, [ODDS_BY_STRIP] = 1 };
	double curve[ODDS_CURVE], worse[ODDS_CURVE], doubtful[ODDS_TRAITS];
	assert_true(odds_open(&net, "config/odds.onnx", &err));
	assert_true(odds_of(curve, clear, net, &err));
	for (int i = 1; i < ODDS_CURVE; i++)
		assert_true(curve[i] >= curve[i - 1]);
	assert_true(odds_log(curve, 0.02) > 3);
	memcpy(doubtful, clear, sizeof doubtful);
	doubtful[ODDS_STRIP_APART] = log(0.2);
	doubtful[ODDS_STRIP_ON] = 0.3;
	doubtful[ODDS_STRIP_OFF] = 0.5;
	doubtful[ODDS_STRIP_WORTH] = -5;
	doubtful[ODDS_STRIP_BEHIND] = 20;
	doubtful[ODDS_SCATTER] = -3;
	doubtful[ODDS_BY_STRIP] = 0;
	assert_true(odds_of(worse, doubtful, net, &err));
	assert_true(odds_log(worse, 0.02) < 0);
	odds_close(net);
}

static void files(void **state)
{
	(void)state;
	struct odds_net *net;
	struct err err = { 0 };
	assert_false(odds_open(&net, "config/none.onnx", &err));
	ERR_HAS(err, "config/none.onnx");
	err = (struct err){ 0 };
	assert_false(odds_open(&net, "config/strip.onnx", &err));  // of another kind
	ERR_HAS(err, "config/strip.onnx");
	odds_close(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(between_tolerances_the_logarithm_is_straight),
		cmocka_unit_test(an_error_wider_than_its_sigma),
		cmocka_unit_test(the_network_that_is_shipped),
		cmocka_unit_test(files),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
