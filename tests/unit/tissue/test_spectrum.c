/* Spectra against what the CIE publishes, and the observer's exact properties. */
#include "tissue/spectrum.h"
#include "tests/lib/unit.h"

#define CHECK_NEAR(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

/* CIE 15, table T.3 and T.8. The fit of the matching functions is good to a per cent of their peak, which moves
 * chromaticities by 0.0015. */
static void test_chromaticities(void **state)
{
	static const double want[][2] = { { 0.3127, 0.3290 }, { 0.3324, 0.3474 }, { 0.3457, 0.3585 }, { 0.4476, 0.4074 },
		                              { 0.3721, 0.3751 }, { 0.3805, 0.3769 }, { 0.3333, 0.3333 } };
	(void)state;
	for (int i = 0; illuminant_names[i]; i++) {
		double sum[3] = { 0 }, bar[3];
		for (int k = 0; k < SPECTRUM_N; k++) {
			observer_xyz(bar, spectrum_nm(k));
			for (int c = 0; c < 3; c++)
				sum[c] += illuminant_power((enum illuminant)i, spectrum_nm(k)) * bar[c];
		}
		CHECK_NEAR(sum[0] / (sum[0] + sum[1] + sum[2]), want[i][0], 0.0015);
		CHECK_NEAR(sum[1] / (sum[0] + sum[1] + sum[2]), want[i][1], 0.0015);
	}
}

/* Illuminant A is 100 at 560 nm by definition, and 241.675 / 9.79510 at 780 / 380 (CIE S 014-2). */
static void test_tungsten(void **state)
{
	(void)state;
	CHECK_NEAR(illuminant_power(ILLUMINANT_A, 560), 1, 1e-12);
	CHECK_NEAR(illuminant_power(ILLUMINANT_A, 780), 2.41675, 1e-4);
	CHECK_NEAR(illuminant_power(ILLUMINANT_A, 380), 0.0979510, 1e-5);
}

/* D65 is 100 at 560 nm; 82.7549 at 400 and 71.6091 at 700 (CIE S 014-2). The components are tabled every 10 nm and
 * rounded to 0.1. */
static void test_daylight(void **state)
{
	(void)state;
	double unit = illuminant_power(ILLUMINANT_D65, 560) / 100;
	CHECK_NEAR(illuminant_power(ILLUMINANT_D65, 400) / unit, 82.7549, 0.05);
	CHECK_NEAR(illuminant_power(ILLUMINANT_D65, 700) / unit, 71.6091, 0.05);
}

static void rgb_of(double rgb[3], const struct observer *o, double (*reflectance)(double))
{
	for (int c = 0; c < 3; c++) {
		rgb[c] = 0;
		for (int i = 0; i < SPECTRUM_N; i++)
			rgb[c] += o->weight[c][i] * reflectance(spectrum_nm(i));
	}
}

static double grey(double nm)
{
	(void)nm;
	return 0.18;
}

static double red(double nm)
{
	return nm > 600 ? 0.9 : 0.05;
}

static double blue(double nm)
{
	return nm < 490 ? 0.9 : 0.05;
}

static void test_observer(void **state)
{
	(void)state;
	for (int i = 0; illuminant_names[i]; i++) {
		struct observer o;
		double rgb[3];
		observer_make(&o, (enum illuminant)i);
		rgb_of(rgb, &o, grey);
		for (int c = 0; c < 3; c++)
			CHECK_NEAR(rgb[c], 0.18, 1e-12);
		rgb_of(rgb, &o, red);
		assert_true(rgb[0] > 5 * rgb[1] && rgb[0] > 5 * rgb[2]);
		rgb_of(rgb, &o, blue);
		assert_true(rgb[2] > 2 * rgb[1] && rgb[2] > 5 * rgb[0]);
	}
}

/* A sum of 5 nm steps of the tabled CIE 1931 functions is 21.371 for each (CIE 15, table T.4). */
static void test_matching_functions(void **state)
{
	double sum[3] = { 0 };
	(void)state;
	for (int i = 0; i < SPECTRUM_N; i++) {
		double xyz[3];
		observer_xyz(xyz, spectrum_nm(i));
		for (int c = 0; c < 3; c++)
			sum[c] += xyz[c];
	}
	for (int c = 0; c < 3; c++)
		CHECK_NEAR(sum[c], 21.371, 0.01 * 21.371);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_chromaticities), cmocka_unit_test(test_tungsten), cmocka_unit_test(test_daylight),
		cmocka_unit_test(test_observer), cmocka_unit_test(test_matching_functions),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
