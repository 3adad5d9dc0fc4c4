#include "draw/photo/lids.h"

#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/plane.h"
#include "iris/iris_map.h"

enum { STEP = 4 };  // px between rays that are traced: it is smooth

static const double fade = 0.4;  // mm inside of the limbus, over which it ends: beyond, nothing is told of it

bool shot_lids_read(struct shot *shot, const json_t *entry, const char *path, struct err *err)
{
	double v[COUNT(shot->lids)], extent;
	if (!json_object_get(entry, "lid_light"))
		return true;
	if (!json_get_array(v, COUNT(v), entry, "lid_light", path, err) || !json_get(&extent, entry, "lid_light_extent_mm", path, err))
		return false;
	if (!(extent > 0.1 && extent < 100))
		return err_set(err, "%s: lid_light_extent_mm: must be in [0.1, 100]", path);
	for (int i = 0; i < COUNT(v); i++) {
		if (!(v[i] >= 0 && v[i] <= 1))
			return err_set(err, "%s: lid_light: must be in [0, 1]", path);
		shot->lids[i] = (float)v[i];
	}
	shot->lids_extent = extent;
	return true;
}

void shot_lids(struct image *rgba, const struct shot *shot, const struct eye *eye)
{
	enum { N = UNREFRACT_LIDS };
	if (!(shot->lids_extent > 0))
		return;
	const struct iris_view view = iris_view_new(&shot->fit, eye);
	const int w = rgba->width / STEP + 2, h = rgba->height / STEP + 2;
	float *node = mem_array(3 * (size_t)w * (size_t)h, sizeof *node);
#pragma omp parallel for schedule(dynamic, 4)
	for (int i = 0; i < w * h; i++) {
		double p[2], rim;
		const double px[2] = { shot->window[0] + STEP * (i % w) * shot->scale, shot->window[1] + STEP * (i / w) * shot->scale };
		const bool iris = iris_see(p, &rim, &view, px);
		const double to = N / (2 * shot->lids_extent);
		const float share = iris ? (float)fmin(fmax((eye->limbus_radius - rim) / fade, 0), 1) : 0;
		for (int c = 0; c < 3; c++)
			node[c * w * h + i] = share > 0 ? 1 + share * (plane_sample(shot->lids + c * N * N, N, N, (p[0] + shot->lids_extent) * to, (p[1] + shot->lids_extent) * to) - 1) : 1;
	}
#pragma omp parallel for schedule(static)
	for (int y = 0; y < rgba->height; y++)
		for (int x = 0; x < rgba->width; x++) {
			float *out = image_at(rgba, x, y);
			for (int c = 0; c < 3; c++)
				out[c] *= plane_sample(node + c * w * h, w, h, (x + 0.5) / STEP + 0.5, (y + 0.5) / STEP + 0.5);
		}
	free(node);
}
