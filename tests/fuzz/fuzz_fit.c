/* limbus/NAME.json, which a user may have edited or taken from elsewhere. */
#include "tests/fuzz/fuzz.h"

#include "anatomy/fit.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct fit fit;
	struct err err = { 0 };
	if (fit_load(&fit, fuzz_file(data, size), &err) && fit.ok) {
		double origin[3], dir[3], px[2] = { 800, 600 }, at[3] = { 1, 2, 3.3 };
		fit_ray(origin, dir, &fit, px);
		fit_project(px, &fit, at);
	}
	return 0;
}
