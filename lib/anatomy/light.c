#include "anatomy/light.h"

#include <stdlib.h>

#include "base/file.h"
#include "bridge/imf_read.h"

enum { LIMIT_PX = 1 << 26 };

bool light_load(struct envmap *env, double *level, struct stage *stage, const char *what, const char *rel, struct err *err)
{
	struct image map;
	char *inside = 0;
	*env = (struct envmap){ 0 };
	if (!file_inside(&inside, stage->capture, rel, err))
		return err_wrap(err, "%s", what);
	free(inside);
	const char *path = stage_path(stage, "%s", rel);
	if (!imf_read_rgb(&map, path, LIMIT_PX, err) || !envmap_take(env, &map, path, err))
		return err_wrap(err, "%s", what);
	double here = envmap_level(env);
	if (level)
		*level = here;
	if (here > 0)
		return true;
	envmap_free(env);
	return err_set(err, "%s: %s: no light falls on what faces the camera: must be the camera's frame, the middle behind the camera", what, path);
}
