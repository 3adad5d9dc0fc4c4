/* The limbus where a person says it is: always returned, near that place, with an honest sigma; nonsense is refused. */
#include "base/mem.h"
#include "limbus/hand.h"
#include "limbus/record.h"
#include "math/rng.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/unit.h"

static double off_by(const struct ellipse *a, const struct ellipse *b)
{
	return fmax(hypot(a->cx - b->cx, a->cy - b->cy), fmax(fabs(a->a - b->a), fabs(a->b - b->b)));
}

static double sigma_of(const struct rim *rim)
{
	double sigma[ELLIPSE_N];
	ellipse_sigma(sigma, &rim->e, rim->cov_q);
	return fmax(fmax(sigma[0], sigma[1]), fmax(sigma[2], sigma[3]));
}

/* Hints off by up to a fifth of the radius, on eyes of which a third and more is covered: the answer is near the hint, and not farther
 * from the truth than its sigma explains. */
static void hints_are_orders(void **state)
{
	(void)state;
	struct limbus_found *found = mem_new(1, sizeof *found);
	struct rng rng = { 7 };
	int n = 0, beyond = 0;
	for (int i = 5; i < SYNTH_GRID; i += SANITISED ? 80 : 16, n++) {
		struct synth_eye eye = synth_eye_grid(i);
		struct synth_truth truth;
		struct photo photo = synth_eye_render(&eye, &truth);
		const double r = truth.limbus.a;
		const double hint[3] = { truth.limbus.cx + rng_range(&rng, -0.15, 0.15) * r, truth.limbus.cy + rng_range(&rng, -0.15, 0.15) * r,
			                 r * rng_range(&rng, 0.85, 1.15) };
		const struct ellipse meant = { hint[0], hint[1], hint[2], hint[2], 0 };
		limbus_find(found, &photo, hint, &limbus_defaults);
		assert_true(found->ok);
		assert_true(limbus_hand_near(&found->limbus.e, &meant));
		beyond += off_by(&found->limbus.e, &truth.limbus) > 3 * sigma_of(&found->limbus) + 0.3;
		photo_free(&photo);
	}
	// A sigma of the hand is one of a hand: an eye turned far is lower than the circle of its hint.
	if (beyond > n / 5)
		fail_msg("%d of %d farther off than three sigma", beyond, n);
	free(found);
}

/* A drawn ellipse close to the limbus ends on it: nearer than it was drawn, and as near as its sigma says. */
static void drawn_ones_end_on_the_edge(void **state)
{
	(void)state;
	struct limbus_found *found = mem_new(1, sizeof *found);
	int n = 0, nearer = 0;
	for (int i = 0; i < 48; i += SANITISED ? 36 : 9, n++) {
		struct synth_eye eye = synth_eye_grid(i);
		struct synth_truth truth;
		struct photo photo = synth_eye_render(&eye, &truth);
		struct ellipse drawn = truth.limbus;
		drawn.cx += 0.01 * drawn.a;
		drawn.a *= 1.01;
		limbus_find_drawn(found, &photo, &drawn, &limbus_defaults);
		assert_true(found->ok && found->by_hand);
		double off = off_by(&found->limbus.e, &truth.limbus);
		nearer += off < 0.7 * off_by(&drawn, &truth.limbus);
		if (!(off < 3 * sigma_of(&found->limbus) + 0.3))
			fail_msg("eye %d: %g px off, sigma %g, as drawn %g", i, off, sigma_of(&found->limbus), off_by(&drawn, &truth.limbus));
		photo_free(&photo);
	}
	assert_true(nearer >= n - 2);
	free(found);
}

/* Where there is no edge at all the ellipse stays as it was said, with the hand's sigma. */
static void without_an_edge_it_stays(void **state)
{
	(void)state;
	struct photo photo = { .width = 320, .height = 240, .bits = 8, .rgb = mem_array(320 * 240 * 3, 2) };
	for (int i = 0; i < 320 * 240 * 3; i++)
		photo.rgb[i] = 150 * 257;
	struct limbus_found *found = mem_new(1, sizeof *found);
	limbus_find(found, &photo, (const double[3]){ 100, 90, 40 }, &limbus_defaults);
	assert_true(found->ok && found->by_hand && !found->has_pupil);
	NEAR(found->limbus.e.cx, 100, 1e-9);
	NEAR(found->limbus.e.a, 40, 1e-9);
	NEAR(sigma_of(&found->limbus), limbus_defaults.hint_sigma * 40, 0.5 * limbus_defaults.hint_sigma * 40);
	const struct ellipse drawn = { 150, 120, 60, 50, 0.3 };
	limbus_find_drawn(found, &photo, &drawn, &limbus_defaults);
	assert_true(found->ok && found->by_hand);
	NEAR(off_by(&found->limbus.e, &drawn), 0, 1e-9);
	NEAR(found->limbus.e.angle, 0.3, 1e-9);
	// What is recorded of it can be read by those who come after.
	struct limbus_record *record = mem_new(1, sizeof *record);
	limbus_record_fill(record, found, &photo);
	assert_true(record->ok && record->by_hand);
	free(record);
	free(found);
	photo_free(&photo);
}

/* Any ellipse that passes the check is survived, wherever it lies: its ring may leave the picture. */
static void extreme_ones_are_survived(void **state)
{
	(void)state;
	struct synth_eye eye = synth_eye_grid(3);
	struct synth_truth truth;
	struct photo photo = synth_eye_render(&eye, &truth);
	struct limbus_found *found = mem_new(1, sizeof *found);
	struct err err = { 0 };
	static const double size[] = { 8, 100, 640 };
	for (int i = 0; i < 2 * 2 * 3; i++) {
		const double r = size[i / 4];
		const struct ellipse e = { i % 2 * photo.width, i / 2 % 2 * photo.height, r, r, 0 };
		assert_true(limbus_hand_check(&e, "photo.a.hint_px", photo.width, photo.height, &err));
		limbus_find(found, &photo, (const double[3]){ e.cx, e.cy, r }, &limbus_defaults);
		assert_true(found->ok && found->limbus.e.b > 0);
		struct ellipse thin = e;
		thin.b = fmax(8, 0.2 * r);
		limbus_find_drawn(found, &photo, &thin, &limbus_defaults);
		assert_true(found->ok && found->limbus.e.b > 0);
	}
	free(found);
	photo_free(&photo);
}

static void nonsense_is_refused(void **state)
{
	(void)state;
	static const struct {
		struct ellipse e;
		const char *says;
	} cases[] = {
		{ { 400, 300, 10000, 10000, 0 }, "photo.a.hint_px: semi-axes 10000 and 10000 px: must be in [8, 800]" },
		{ { -1, 300, 100, 100, 0 }, "must lie in the photograph, 800 x 600 px" },
		{ { 400, 601, 100, 100, 0 }, "must lie in the photograph" },
		{ { NAN, 300, 100, 100, 0 }, "must lie in the photograph" },
		{ { 400, 300, 3, 3, 0 }, "must be in [8, 800]" },
		{ { 400, 300, NAN, NAN, 0 }, "must be in [8, 800]" },
		{ { 400, 300, 80, 100, 0 }, "the major one comes first" },
	};
	for (int i = 0; i < COUNT(cases); i++) {
		struct err err = { 0 };
		assert_false(limbus_hand_check(&cases[i].e, "photo.a.hint_px", 800, 600, &err));
		ERR_HAS(err, cases[i].says);
	}
}

/* Said twice of one eye it is one place; two eyes are two. */
static void places_agree(void **state)
{
	(void)state;
	const struct ellipse hint = { 400, 300, 100, 100, 0 }, near = { 410, 295, 105, 90, 0.3 }, far = { 500, 300, 100, 95, 0 }, small = { 400, 300, 40, 40, 0 };
	struct err err = { 0 };
	assert_true(limbus_hand_agree(&hint, "h", &near, "d", true, &err));
	assert_false(limbus_hand_agree(&hint, "h", &far, "d", true, &err));
	ERR_HAS(err, "h with d: their centres are 100 px apart, their radii 100 and 100 px: both must mean one limbus");
	err = (struct err){ 0 };
	assert_false(limbus_hand_agree(&hint, "h", &small, "d", true, &err));
	err = (struct err){ 0 };
	const struct ellipse other = { 900, 320, 80, 80, 0 };
	assert_true(limbus_hand_agree(&hint, "l", &other, "r", false, &err));
	assert_true(limbus_hand_agree(&other, "l", &hint, "r", false, &err));
	assert_false(limbus_hand_agree(&hint, "l", &near, "r", false, &err));
	ERR_HAS(err, "l with r: their centres are 11 px apart: two eyes stand further apart");
	err = (struct err){ 0 };
	assert_false(limbus_hand_agree(&small, "l", &hint, "r", false, &err));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(hints_are_orders),      cmocka_unit_test(drawn_ones_end_on_the_edge), cmocka_unit_test(without_an_edge_it_stays),
		cmocka_unit_test(extreme_ones_are_survived), cmocka_unit_test(nonsense_is_refused), cmocka_unit_test(places_agree),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
