/* COLMAP's model files. The first byte says text or binary, two more where the bytes are cut into three files. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "sfm/colmap/colmap.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const where[] = { "cameras", "images", "points3D" };
	if (size < 5)
		return 0;
	size_t cut[2] = { data[1] + 256u * data[2], data[3] + 256u * data[4] }, left = size - 5, sizes[3];
	sizes[0] = cut[0] < left ? cut[0] : left;
	sizes[1] = cut[1] < left - sizes[0] ? cut[1] : left - sizes[0];
	sizes[2] = left - sizes[0] - sizes[1];
	char *files[3];
	const uint8_t *at = data + 5;
	for (int i = 0; i < 3; i++) {
		files[i] = malloc(sizes[i] + 1);
		memcpy(files[i], at, sizes[i]);
		files[i][sizes[i]] = 0;
		at += sizes[i];
	}
	struct colmap_model m;
	struct err err = { 0 };
	const char *const views[] = { files[0], files[1], files[2] };
	if (colmap_parse(&m, data[0] & 1 ? COLMAP_TEXT : COLMAP_BINARY, views, sizes, where, &err)) {
		colmap_residual(&m, -1);
		colmap_check_errors(&m, "model", &err);
		colmap_free(&m);
	} else if (!err_is(&err))
		abort();
	for (int i = 0; i < 3; i++)
		free(files[i]);
	return 0;
}
