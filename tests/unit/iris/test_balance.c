/* balance: the light's colour from a drawn sclera, in white light and in tungsten's, and colour temperatures of colours that are known. */
#include "base/mem.h"
#include "iris/balance.h"
#include "tests/lib/unit.h"

enum { WIDE = 600, HIGH = 400 };
static const struct balance_conf conf = { .sclera = { 0.66, 0.55, 0.48 }, .inner = 1.1, .outer = 1.6, .dark = 0.3, .share_min = 0.02 };
static const struct fit fit = { .ok = true, .limbus = { 300, 200, 100, 100, 0 }, .width = WIDE, .height = HIGH };

/* An eye of semi-axis 100 px in its middle: sclera between lids that are `open` px apart, its left half in deep shadow, skin beyond, a
 * clipped glint, in that light. */
static struct photo picture(double open, const double light[3])
{
	static const double skin[3] = { 0.5, 0.26, 0.18 };
	struct photo photo = { .width = WIDE, .height = HIGH, .bits = 16, .rgb = mem_array(3 * WIDE * HIGH, sizeof(uint16_t)) };
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++) {
			double u = x - 299.5, v = y - 199.5;
			for (int c = 0; c < 3; c++) {
				double value = hypot(u - 130, v + 10) < 6 ? 1 : light[c] * (fabs(v) > open / 2 ? skin[c] : hypot(u, v) < 100 ? 0.1 : conf.sclera[c] * (u < 0 ? 0.1 : 1));
				photo.rgb[3 * (y * WIDE + x) + c] = (uint16_t)(65535 * srgb_from_linear((float)value) + 0.5);
			}
		}
	return photo;
}

/* Evidence of such an eye as it is, a pixel for 4 x 4 of the photograph. */
static struct evidence told(double open)
{
	enum { W = WIDE / 4, H = HIGH / 4 };
	struct evidence e = { .width = W, .height = H, .scale = 4 };
	e.plane[0] = mem_new((size_t)EVIDENCE_CLASSES * W * H, sizeof(float));
	for (int k = 1; k < EVIDENCE_CLASSES; k++)
		e.plane[k] = e.plane[0] + (long)k * W * H;
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double u = 4 * x - 298, v = 4 * y - 198;
			e.plane[fabs(v) > open / 2 ? EVIDENCE_SKIN : hypot(u, v) < 100 ? EVIDENCE_IRIS : EVIDENCE_SCLERA][y * W + x] = 1;
		}
	return e;
}

/* In tungsten light the sclera is redder than skin is in daylight. */
static void light_of_any_colour(void **state)
{
	(void)state;
	static const double lights[][3] = { { 0.9, 0.9, 0.9 }, { 0.9, 0.5, 0.2 }, { 0.6, 0.7, 0.9 } };
	for (int i = 0; i < 3; i++) {
		struct photo photo = picture(150, lights[i]);
		struct evidence evidence = told(140);
		struct balance white = balance_sclera(&photo, &fit, &evidence, &conf);
		assert_true(white.found);
		for (int c = 0; c < 3; c++)  // 16 bits of sRGB: 1e-4
			NEAR(white.rgb[c], lights[i][c], 1e-3);
		assert_true(white.spread < 0.01);
		photo_free(&photo);
		evidence_free(&evidence);
	}
}

static void no_sclera_no_white(void **state)
{
	(void)state;
	static const double light[3] = { 0.9, 0.5, 0.2 };
	struct photo photo = picture(150, light);
	struct evidence evidence = told(0);
	struct balance white = balance_sclera(&photo, &fit, &evidence, &conf);
	assert_false(white.found);
	assert_true(white.rgb[0] == 1 && white.rgb[1] == 1 && white.rgb[2] == 1);
	assert_false(balance_sclera(&photo, &fit, 0, &conf).found);
	photo_free(&photo);
	evidence_free(&evidence);
}

/* sRGB's white is D65, 6504 K; illuminant A (x 0.44757, y 0.40745) is a black body of 2856 K. */
static void temperatures(void **state)
{
	(void)state;
	const double x = 0.44757, y = 0.40745, X = x / y, Z = (1 - x - y) / y, d65[] = { 1, 1, 1 }, green[] = { 0, 1, 0 };
	const double a[] = { 3.2406 * X - 1.5372 - 0.4986 * Z, -0.9689 * X + 1.8758 + 0.0415 * Z, 0.0557 * X - 0.2040 + 1.0570 * Z };
	NEAR(balance_kelvin(d65), 6504, 15);  // McCamy's polynomial is good to 2 K there; matrices of four digits
	NEAR(balance_kelvin(a), 2856, 15);
	assert_true(isnan(balance_kelvin(green)) || balance_kelvin(green) > 5000);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(light_of_any_colour), cmocka_unit_test(no_sclera_no_white),
		                            cmocka_unit_test(temperatures) };
	return cmocka_run_group_tests(tests, 0, 0);
}
