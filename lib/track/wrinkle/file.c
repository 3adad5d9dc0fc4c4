#include <math.h>

#include "base/json.h"
#include "track/wrinkle/wrinkle.h"

static json_t *floats(int n, const float *x)
{
	json_t *list = json_array();
	for (int i = 0; i < n; i++)
		json_array_append_new(list, json_number((double)x[i]));
	return list;
}

static json_t *line_json(const struct wrinkle_line *line, int n_frames)
{
	json_t *j = json_object(), *points = json_array(), *depth = json_array(), *shift = json_array();
	json_object_set_new(j, "length_mm", json_number(line->length));
	for (int i = 0; i < line->n; i++) {
		const struct wrinkle_point *p = &line->point[i];
		json_t *q = json_object();
		json_object_set_new(q, "px", json_numbers(2, p->px));
		json_object_set_new(q, "head_mm", json_numbers(3, p->mm));
		json_object_set_new(q, "across", json_numbers(3, p->across));
		json_object_set_new(q, "face", json_integer(p->face));
		json_object_set_new(q, "bary", json_numbers(2, p->bary));
		json_object_set_new(q, "depth_mm", json_number(p->depth));
		json_object_set_new(q, "half_width_mm", json_number(p->width));
		json_array_append_new(points, q);
	}
	for (int k = 0; k < n_frames; k++) {
		json_array_append_new(depth, floats(line->n, line->depth + (long)k * line->n));
		json_array_append_new(shift, floats(line->n, line->shift + (long)k * line->n));
	}
	json_object_set_new(j, "points", points);
	json_object_set_new(j, "depth_mm", depth);
	json_object_set_new(j, "shift_mm", shift);
	return j;
}

bool wrinkles_save(const struct wrinkles *w, const char *path, const char *made_by, struct err *err)
{
	json_t *j = json_object(), *poses = json_array();
	json_object_set_new(j, "chart", json_numbers(4, (double[]){ w->x0, w->y0, w->width, w->height }));
	json_object_set_new(j, "px_per_mm", json_number(w->px_per_mm));
	json_object_set_new(j, "light_ambient", json_number(w->ambient));
	json_object_set_new(j, "light_from", json_numbers(3, w->from));
	for (int i = 0; i < w->n; i++) {
		const struct wrinkle_pose *p = &w->pose[i];
		json_t *q = json_object(), *lines = json_array(), *frames = json_array();
		for (int k = 0; k < p->n_frames; k++)
			json_array_append_new(frames, json_integer(p->frame[k]));
		for (int k = 0; k < p->n; k++)
			json_array_append_new(lines, line_json(&p->line[k], p->n_frames));
		json_object_set_new(q, "name", json_string(p->name));
		json_object_set_new(q, "frames", frames);
		json_object_set_new(q, "lines", lines);
		json_array_append_new(poses, q);
	}
	json_object_set_new(j, "expressions", poses);
	bool ok = json_write(path, j, made_by, err);
	json_decref(j);
	return ok;
}
