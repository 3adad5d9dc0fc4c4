/* EXR maps, as a stage reads another's. */
#include "tests/fuzz/fuzz.h"

#include "image/exr.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const rgb[] = { "R", "G", "B" }, *const y[] = { "Y" };
	struct image image;
	struct err err = { 0 };
	struct exr_info info;
	const char *path = fuzz_file(data, size);
	if (exr_read(&image, path, 3, rgb, 100000, &info, &err))
		image_free(&image);
	err = (struct err){ 0 };
	if (exr_read(&image, path, 1, y, 100000, &info, &err))
		image_free(&image);
	return 0;
}
