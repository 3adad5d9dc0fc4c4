/* How wide sensors are, against the makers' data sheets; the longest name that fits decides. */
#include "optics/sensor.h"
#include "tests/lib/unit.h"

/* Longer side of the sensor, mm: a lens of 1 mm before a picture of 1000 px. */
static double width(const char *model)
{
	return 1000 / sensor_focal_px(model, 1, 1000);
}

static void test_table(void **state)
{
	(void)state;
	static const struct {
		const char *model;
		double mm;
	} sheet[] = {
		{ "Canon EOS 5D Mark III", 36.0 }, { "Canon EOS 600D", 22.3 }, { "Canon EOS R", 36.0 },    { "Canon EOS R7", 22.3 },
		{ "NIKON D850", 35.9 },            { "NIKON D7200", 23.5 },    { "NIKON D700", 36.0 },     { "NIKON D5", 35.9 },
		{ "NIKON D500", 23.5 },            { "NIKON D5100", 23.6 },    { "NIKON D300", 23.6 },     { "NIKON Z 50", 23.5 },
		{ "NIKON Z 6_2", 35.9 },           { "ILCE-7RM4", 35.8 },      { "ILCE-6400", 23.5 },      { "DSC-RX100M3", 13.2 },
		{ "DSC-RX1RM2", 35.8 },            { "DC-GH5", 17.3 },         { "E-M1MarkII", 17.3 },     { "X-T3", 23.5 },
	};
	for (size_t i = 0; i < sizeof sheet / sizeof *sheet; i++)
		if (!(fabs(width(sheet[i].model) - sheet[i].mm) < 0.051))
			fail_msg("%s: %g mm for %g", sheet[i].model, width(sheet[i].model), sheet[i].mm);
	assert_true(isnan(width("")));
	assert_true(isnan(width("iPhone 14")));  // it says its 35 mm equivalent itself
	assert_true(isnan(width("canon eos 600d")));
	assert_true(fabs(sensor_focal_px("Canon EOS 600D", 100, 5184) - 100 / 22.3 * 5184) < 1e-9);
	assert_true(isnan(sensor_focal_px("Canon EOS 600D", NAN, 5184)) && isnan(sensor_focal_px("iPhone 14", 4, 4032)));
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_table) };
	return cmocka_run_group_tests(tests, 0, 0);
}
