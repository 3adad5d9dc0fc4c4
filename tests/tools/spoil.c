/* spoil: one iris map made into another that something is wrong with, for the scripts of tests/chain.
 *
 *     spoil KIND CHANNELS IN OUT
 * KIND: nan (a block of no numbers), half (half as many pixels each way), oblong (not square), extent (half-width of another
 * eye). CHANNELS: names, comma-separated, at most 4
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/exr.h"

static void blind(struct image *map)
{
	for (int y = map->height / 3; y < map->height / 2; y++)
		for (int x = 0; x < map->width; x++)
			for (int c = 0; c < map->channels; c++)
				image_at(map, x, y)[c] = NAN;
}

/* Every step_x-th and step_y-th pixel. */
static void thin_out(struct image *map, int step_x, int step_y)
{
	struct image out = image_new(map->width / step_x, map->height / step_y, map->channels);
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++)
			memcpy(image_at(&out, x, y), image_at(map, x * step_x, y * step_y), (size_t)map->channels * sizeof *map->px);
	image_free(map);
	*map = out;
}

int main(int argc, char **argv)
{
	struct err err = { 0 };
	struct image map;
	struct exr_info info = { 0 };
	const char *names[4];
	int n = 0;
	if (argc != 5)
		return 2;
	for (char *name = strtok(argv[2], ","); name && n < 4; name = strtok(0, ","))
		names[n++] = name;
	if (!exr_read(&map, argv[3], n, names, 1L << 26, &info, &err)) {
		fprintf(stderr, "spoil: %s\n", err.msg);
		return 1;
	}
	if (!strcmp(argv[1], "nan"))
		blind(&map);
	else if (!strcmp(argv[1], "half"))
		thin_out(&map, 2, 2);
	else if (!strcmp(argv[1], "oblong"))
		thin_out(&map, 1, 2);
	else
		info.extent_mm *= 1.5;
	bool ok = exr_write(argv[4], &map, names, EXR_HALF, &info, &err);
	if (!ok)
		fprintf(stderr, "spoil: %s\n", err.msg);
	image_free(&map);
	return ok ? 0 : 1;
}
