/* White in a photograph, from its sclera or a card, and how bright the light on the eye is: closed forms, drawn pictures. */
#include "base/mem.h"
#include "image/image.h"
#include "tests/lib/conf/white_conf.h"
#include "tests/lib/unit.h"
#include "tissue/pigment/white.h"

#define CHECK_NEAR(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

enum { WIDE = 600, HIGH = 400 };

/* An eye of semi-axis 100 px in its middle: sclera between lids that are `open` px apart, skin beyond, a clipped glint. */
static struct photo picture(double open, const double sclera[3])
{
	struct photo photo = { .width = WIDE, .height = HIGH, .bits = 16, .rgb = mem_array(3 * WIDE * HIGH, sizeof(uint16_t)) };
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++) {
			double u = x - 299.5, v = y - 199.5, r = hypot(u, v);
			bool skin = fabs(v) > open / 2, glint = hypot(u - 130, v + 10) < 6;
			for (int c = 0; c < 3; c++) {
				double value = glint ? 1 : r < 100 && !skin ? 0.1 : skin ? (const double[]) { 0.5, 0.26, 0.18 }[c] : sclera[c];
				photo.rgb[3 * (y * WIDE + x) + c] = (uint16_t)(65535 * srgb_from_linear((float)value) + 0.5);
			}
		}
	return photo;
}

static bool sclera_white(struct white *white, const struct photo *photo, const struct fit *fit, const struct evidence *evidence)
{
	static const double grey[3] = { 1, 1, 1 };
	static const struct eye eye = { .limbus_radius = 5.85, .cornea_radius = 7.8, .cornea_asphericity = 0.75, .iris_depth = 3.3 };
	static struct pale samples[PALE_MAX];
	struct envmap env = envmap_room(64, grey, grey, 1, 0, 0);
	int n = pale_find(samples, photo, fit, &eye, evidence, &white_defaults.pale);
	bool found = white_sclera(white, samples, n, &env, &white_defaults);
	envmap_free(&env);
	return found;
}

static void test_white(void **state)
{
	const double want[] = { 0.8, 0.7, 0.6 };
	const double sclera[] = { 0.66 * 0.8, 0.55 * 0.7, 0.48 * 0.6 };
	const struct fit fit = { .ok = true, .limbus = { 300, 200, 100, 100, 0 }, .width = WIDE, .height = HIGH };
	const double card[] = { 300, 30, 15 }, glint[] = { 430, 190, 8 };
	struct white white;
	struct err err = { 0 };
	(void)state;
	struct photo open = picture(150, sclera), shut = picture(20, sclera);
	assert_true(sclera_white(&white, &open, &fit, 0));
	for (int c = 0; c < 3; c++)  // a sphere of light as 128 directions: a per cent
		CHECK_NEAR(white.rgb[c], want[c], 0.015);
	assert_int_equal(white.source, WHITE_SCLERA);
	assert_true(white.spread < 0.01);
	bool found = sclera_white(&white, &shut, &fit, 0);
	for (int c = 0; c < 3 && found; c++)  // a slit: either none, or the right one
		CHECK_NEAR(white.rgb[c], want[c], 0.02);
	assert_true(white_card(&white, &open, card, &white_defaults, &err));
	CHECK_NEAR(white.rgb[1], 0.26 / 0.18, 1e-3);
	assert_false(white_card(&white, &open, glint, &white_defaults, &err));
	assert_non_null(strstr(err.msg, "over-exposed"));
	photo_free(&open);
	photo_free(&shut);
}

/* A face's whites: alike, they stay; skin at one eye gives way to the other's; light that differs, as the irises show, stays apart; what is asked
 * of one eye is asked of the other alike. */
static void test_white_pair(void **state)
{
	static const struct { double own[2], fellow[2], iris[2], want[2], within; } cases[] = {
		{ { 0.1, -0.1 }, { 0.1, -0.1 }, { 0, 0 }, { 0.1, -0.1 }, 0.03 },
		{ { 0.4, -0.3 }, { 0.1, -0.1 }, { 0, 0 }, { 0.1, -0.1 }, 0.08 },
		{ { 0.1, -0.1 }, { 0.4, -0.3 }, { 0, 0 }, { 0.1, -0.1 }, 0.03 },
		{ { 0.4, -0.3 }, { 0.1, -0.1 }, { 0.3, -0.2 }, { 0.4, -0.3 }, 0.06 },
		{ { -0.2, 0.3 }, { 0.1, -0.1 }, { -0.3, 0.4 }, { -0.2, 0.3 }, 0.05 },
		{ { 3, -3 }, { -3, 3 }, { 6, -6 }, { 3, -3 }, 0.06 },  // far beyond what any light is
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double got[CHROMA];
		white_pair(got, cases[i].own, cases[i].fellow, cases[i].iris, &white_pair_defaults);
		for (int k = 0; k < CHROMA; k++)
			CHECK_NEAR(got[k], cases[i].want[k], cases[i].within);
	}
	double own[CHROMA], iris[CHROMA], moved[CHROMA];  // all colours multiplied: so is what follows
	const double a[] = { 0.3, -0.2 }, b[] = { 0.15, -0.05 }, differ[] = { 0.02, 0.01 }, by[] = { 0.7, -0.9 };
	white_pair(own, a, b, differ, &white_pair_defaults);
	white_pair(moved, (const double[]){ a[0] + by[0], a[1] + by[1] }, (const double[]){ b[0] + by[0], b[1] + by[1] }, differ, &white_pair_defaults);
	for (int k = 0; k < CHROMA; k++)
		CHECK_NEAR(moved[k], own[k] + by[k], 1e-9);
	white_pair(iris, a, b, 0, &white_pair_defaults);  // nothing known of the irises
	assert_true(iris[0] > b[0] - 0.05 && iris[0] < a[0]);
}

/* What a network would say of such a picture: sclera between the lids, outside the iris. */
static struct evidence said(double open)
{
	enum { STEP = 5 };
	struct evidence e = { .width = WIDE / STEP, .height = HIGH / STEP, .scale = STEP };
	const size_t n = (size_t)e.width * (size_t)e.height;
	e.plane[0] = mem_new(EVIDENCE_CLASSES * n, sizeof **e.plane);
	for (int k = 1; k < EVIDENCE_CLASSES; k++)
		e.plane[k] = e.plane[0] + (size_t)k * n;
	for (size_t i = 0; i < n; i++) {
		const double u = ((double)(i % (size_t)e.width) + 0.5) * STEP - 300, v = ((double)(i / (size_t)e.width) + 0.5) * STEP - 200;
		e.plane[fabs(v) > open / 2 ? EVIDENCE_SKIN : hypot(u, v) < 100 ? EVIDENCE_IRIS : EVIDENCE_SCLERA][i] = 1;
	}
	return e;
}

/* Skin that a light makes as pale as the sclera, and twice as bright: colour alone takes it for white, the evidence does not. */
static void test_pale_skin(void **state)
{
	const struct fit fit = { .ok = true, .limbus = { 300, 200, 100, 100, 0 }, .width = WIDE, .height = HIGH };
	const double sclera[] = { 0.66 * 0.2, 0.55 * 0.2, 0.48 * 0.2 };
	struct white fooled, white;
	(void)state;
	struct photo photo = picture(150, sclera);
	for (long i = 0; i < WIDE * HIGH; i++)
		if (labs(i / WIDE - 200) > 75)
			for (int c = 0; c < 3; c++)
				photo.rgb[3 * i + c] = (uint16_t)(65535 * srgb_from_linear((float)(2.2 * sclera[c])) + 0.5);
	struct evidence evidence = said(150);
	assert_true(sclera_white(&fooled, &photo, &fit, 0) && sclera_white(&white, &photo, &fit, &evidence));
	assert_true(fooled.rgb[1] > 0.4);
	for (int c = 0; c < 3; c++)
		CHECK_NEAR(white.rgb[c], 0.2, 0.005);
	evidence_free(&evidence);
	evidence = said(0);  // shut, as the network has it
	assert_false(sclera_white(&white, &photo, &fit, &evidence));
	evidence_free(&evidence);
	photo_free(&photo);
}

/* The light on the eye: as the white has it that was measured on the sclera; over a card's or the camera's as much as the sclera shows; where the sclera's shading
 * was fitted, as it is photographed but for a bounded part of that. */
static void test_level(void **state)
{
	struct white_conf conf = white_defaults;
	struct white white = { .rgb = { 1, 1, 1 }, .sclera = { 0.66, 0.55, 0.48 }, .shade = 1 };
	(void)state;
	CHECK_NEAR(white_level(&white, false, &conf), 1, 1e-12);
	white.shade = 0.95;  // a little: believed
	CHECK_NEAR(white_level(&white, false, &conf), 1, 0.002);
	white.shade = 0.5;   // an eye of which one side shows: the light as photographed, and shade_most more
	CHECK_NEAR(white_level(&white, false, &conf), 0.5 * exp(0.2), 0.005);
	CHECK_NEAR(white_level(&white, true, &conf), 1, 1e-12);
	CHECK_NEAR(white_level_sigma(&white, true), 0.12, 1e-12);
	CHECK_NEAR(white_level_sigma(&white, false), hypot(0.12, log(2) / 2), 1e-12);
	conf.shade_most = 0;
	CHECK_NEAR(white_level(&white, false, &conf), 0.5, 1e-12);
	for (int c = 0; c < 3; c++)  // a card in the open, an eye in the shade of its brow
		white.sclera[c] *= 0.3;
	white.shade = 1;
	CHECK_NEAR(white_level(&white, false, &conf), 0.3, 1e-12);
	const struct white none = { .rgb = { 1, 1, 1 } };
	assert_true(white_level(&none, false, &conf) == 1 && isnan(white_level_sigma(&none, false)));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_white), cmocka_unit_test(test_pale_skin), cmocka_unit_test(test_level), cmocka_unit_test(test_white_pair),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
