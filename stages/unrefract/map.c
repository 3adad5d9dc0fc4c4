#include <stdlib.h>

#include "base/mem.h"
#include "image/exr.h"
#include "unrefract.h"

bool unrefract_write_map(const struct run *run, const struct capture_photo *photo, const struct unrefract_view *view,
                         const char *iris, struct err *err)
{
	static const char *const channels[] = { "X", "Y" };
	char *path = mem_printf("%s/%s.map.exr", iris, photo->name);
	const char *const in[] = { photo->file, photo->fit };
	bool ok = stage_fresh(run->stage, path, COUNT(in), in);
	if (!ok) {
		// in the photograph's own eye frame, that of its limbus/NAME.json
		struct iris_view own = iris_view_new(view->fit, run->eye);
		double limbus = run->eye->limbus_radius;
		struct image map = iris_map_forward(&own, limbus, limbus);
		struct exr_info info = { 0, stage_made_by(run->stage, COUNT(in), in) };
		ok = exr_write(stage_path(run->stage, "%s", path), &map, channels, EXR_FLOAT, &info, err)
		     && stage_made(run->stage, path, COUNT(in), in, err);
		image_free(&map);
	}
	free(path);
	return ok;
}
