/* Photographs of every kind: head, then decoder. */
#include "tests/fuzz/fuzz.h"

#include "image/photo/photo.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct photo photo;
	struct err err = { 0 };
	if (photo_load(&photo, fuzz_file(data, size), 0.3, &err)) {
		struct image image = photo_linear(&photo, 0, 0, photo.width, photo.height);
		image_free(&image);
		photo_free(&photo);
	} else if (!err_is(&err))
		abort();  // refused without a word
	return 0;
}
