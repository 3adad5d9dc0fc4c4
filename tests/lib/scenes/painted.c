#include "tests/lib/scenes/painted.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "tests/lib/scratch.h"

static bool write_maps(const struct scene_files *files, int size, painted_colour *colour, painted_height *height,
                       double pupil, struct err *err)
{
	struct exr_info info = { .extent_mm = painted_extent, .made_by = "{}" };
	struct image tex = image_new(size, size, 4), relief = image_new(size, size, 2);
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			double u = (x + 0.5) * 2 * painted_extent / size - painted_extent;
			double v = (y + 0.5) * 2 * painted_extent / size - painted_extent;
			colour(image_at(&tex, x, y), u, v);
			image_at(&tex, x, y)[3] = hypot(u, v) < 6.2;
			image_at(&relief, x, y)[0] = height ? (float)height(u, v) : 0;
			image_at(&relief, x, y)[1] = 0.5f;
		}
	char text[100];
	int n = snprintf(text, sizeof text, "{\"pupil\": {\"cx\": 0, \"cy\": 0, \"r\": %g}}", pupil);
	bool ok = exr_write(files->texture, &tex, (const char *const[]){ "R", "G", "B", "W" }, EXR_FLOAT, &info, err)
	          && exr_write(files->relief, &relief, (const char *const[]){ "Y", "T" }, EXR_FLOAT, &info, err)
	          && file_write(files->texture_json, text, (size_t)n, err);
	image_free(&tex);
	image_free(&relief);
	return ok;
}

bool painted_scene(struct scene *scene, int size, const struct eye *eye, const struct scene_conf *conf,
                   painted_colour *colour, painted_height *height, double pupil, struct err *err)
{
	char *dir = scratch_folder();
	char *texture = mem_printf("%s/texture.exr", dir), *json = mem_printf("%s/texture.json", dir), *relief = mem_printf("%s/relief.exr", dir);
	struct scene_files files = { texture, json, relief, 0, 0 };
	bool ok = write_maps(&files, size, colour, height, pupil, err) && scene_load(scene, &files, eye, conf, err);
	free(texture);
	free(json);
	free(relief);
	scratch_folder_remove(dir);
	return ok;
}
