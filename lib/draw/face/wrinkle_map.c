#include "draw/face/wrinkle_map.h"

#include <math.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"
#include "draw/face/skin_look.h"

static const long limit_px = 100000000;
static const float step = (float)SKIN_FOLD_STEP;

static bool read_names(struct wrinkle_maps *m, const char *path, struct err *err)
{
	double chart[4];
	json_t *json = json_read(path, 256 << 20, err), *list = json ? json_object_get(json, "expressions") : 0, *one;
	bool ok = json && json_get_array(chart, 4, json, "chart", path, err) && json_get(&m->px_per_mm, json, "px_per_mm", path, err);
	if (ok && (!json_is_array(list) || !(m->px_per_mm > 0)))
		ok = err_set(err, "%s: px_per_mm, expressions: not as track writes them: run it again", path);
	size_t i;
	m->name = mem_new(json_array_size(list) + 1, sizeof *m->name);
	m->folds = mem_new(json_array_size(list) + 1, sizeof *m->folds);
	json_array_foreach(list, i, one) {
		const char *name = ok ? json_get_string(one, "name", path, err) : 0;
		ok = ok && name;
		if (!ok)
			break;
		m->folds[m->n] = json_array_size(json_object_get(one, "lines")) > 0;
		m->name[m->n++] = mem_str(name);
	}
	m->x0 = ok ? (int)chart[0] : 0;
	m->y0 = ok ? (int)chart[1] : 0;
	json_decref(json);
	return ok;
}

bool wrinkle_maps_load(struct wrinkle_maps *m, const char *dir, struct err *err)
{
	char *json = mem_printf("%s/wrinkles.json", dir), *exr = mem_printf("%s/wrinkles.exr", dir);
	*m = (struct wrinkle_maps){ 0 };
	bool ok = true;
	if (file_exists(json) && file_exists(exr) && (ok = read_names(m, json, err)) && m->n) {
		char **channel = mem_new(2 * (size_t)m->n, sizeof *channel);
		for (int i = 0; i < 2 * m->n; i++)
			channel[i] = mem_printf("%s.%s", m->name[i / 2], i % 2 ? "open" : "height");
		ok = exr_read(&m->map, exr, 2 * m->n, (const char *const *)channel, limit_px, 0, err);
		for (int i = 0; i < 2 * m->n; i++)
			free(channel[i]);
		free(channel);
	}
	free(json);
	free(exr);
	return ok;
}

void wrinkle_maps_free(struct wrinkle_maps *m)
{
	for (int i = 0; i < m->n; i++)
		free(m->name[i]);
	free(m->name);
	free(m->folds);
	image_free(&m->map);
	*m = (struct wrinkle_maps){ 0 };
}

bool wrinkle_maps_at(float slope[2], float *open, const struct wrinkle_maps *m, const float *strength, const float px[2])
{
	double x = (double)px[0] - m->x0, y = (double)px[1] - m->y0;
	slope[0] = slope[1] = 0;
	*open = 1;
	if (!(x > 1 && y > 1 && x < m->map.width - 1 && y < m->map.height - 1))
		return false;
	for (int i = 0; i < m->n; i++) {
		if (!m->folds[i] || !(strength[i] > 0) || image_sample(&m->map, x, y, 2 * i + 1) > 0.9995f)
			continue;
		slope[0] += strength[i] * (image_sample(&m->map, x + (double)step, y, 2 * i) - image_sample(&m->map, x - (double)step, y, 2 * i)) / (2 * step);
		slope[1] += strength[i] * (image_sample(&m->map, x, y + (double)step, 2 * i) - image_sample(&m->map, x, y - (double)step, 2 * i)) / (2 * step);
		*open *= 1 - strength[i] * (1 - image_sample(&m->map, x, y, 2 * i + 1));
	}
	return *open < 1 || slope[0] != 0 || slope[1] != 0;
}
