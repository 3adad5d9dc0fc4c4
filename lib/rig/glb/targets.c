#include "rig/glb/targets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static const double off_mm = 0.03;  // of all targets of 8 bits together
static const double most_mm = 500;  // a step is 15 um then: what goes further is kept as it is

static double most_of(const float *x, size_t n, double most)
{
	for (size_t i = 0; x && i < n; i++)
		most = fmax(most, fabs((double)x[i]));
	return most;
}

double glb_unit(const struct glb_bake *b, const struct look *look)
{
	const size_t skin = 3 * (size_t)b->n, hair = 3 * (size_t)b->n_hair, ours = (size_t)b->n_targets, poses = (size_t)b->n_poses;
	double most = most_of(b->target, ours * skin, 0);
	most = most_of(b->pose, poses * skin, most);
	most = most_of(b->hair_target, ours * hair, most);
	most = most_of(b->hair_pose, poses * hair, most);
	if (look && look->n_shapes)
		most = most_of(look->shape_by[0], 3 * (size_t)look->shape_start[look->n_shapes], most);
	return most > 0 ? fmin(most, most_mm) : 1000;
}

void glb_targets_small(double *gain, const double *most, int n, double unit)
{
	double left = off_mm;
	for (int k = 0; k < n; k++)
		gain[k] = 0;
	for (int round = 0; round < n; round++) {
		int least = -1;
		for (int k = 0; k < n; k++)
			least = gain[k] == 0 && most[k] > 0 && (least < 0 || most[k] < most[least]) ? k : least;
		if (least < 0 || (left -= sqrt(3) * most[least] / (2 * INT8_MAX)) < 0)
			break;
		gain[least] = fmax(unit / most[least], 1);
	}
}

struct glb_targets glb_targets_new(void)
{
	return (struct glb_targets){ json_array(), json_array() };
}

void glb_targets_free(struct glb_targets *t)
{
	json_decref(t->list);
	json_decref(t->names);
	*t = (struct glb_targets){ 0 };
}

/* Whether a row is nothing but zeros, in steps. */
static bool rests(const float *x, double unit, int steps)
{
	return !lrint(steps * x[0] / unit) && !lrint(steps * x[1] / unit) && !lrint(steps * x[2] / unit);
}

static int add_steps(struct glb_buffer *g, const float *x, const uint32_t *row, int few, int rows, int all, double unit, int bits, bool range)
{
	const int steps = (1 << (bits - 1)) - 1;
	int16_t *step = mem_new(3 * (size_t)few + 1, sizeof *step);
	for (int i = 0; i < few; i++)
		for (int c = 0; c < 3; c++)
			step[3 * i + c] = (int16_t)lrint(steps * x[3 * row[i] + (uint32_t)c] / unit);
	const int accessor = glb_add_sparse_steps(g, step, few, rows, all, bits, range);
	free(step);
	return accessor;
}

static int add_floats(struct glb_buffer *g, const float *x, const uint32_t *row, int few, int rows, int all, double unit)
{
	float *some = mem_new(3 * (size_t)few + 1, sizeof *some);
	for (int i = 0; i < few; i++)
		for (int c = 0; c < 3; c++)
			some[3 * i + c] = (float)(x[3 * row[i] + (uint32_t)c] / unit);
	const int accessor = glb_add_sparse(g, some, few, rows, all);
	free(some);
	return accessor;
}

static int add_places(struct glb_buffer *g, const float *x, const uint32_t *row, int few, int rows, int all, double unit)
{
	const bool fits = most_of(x, 3 * (size_t)all, 0) <= unit;
	return fits ? add_steps(g, x, row, few, rows, all, unit, 16, true) : add_floats(g, x, row, few, rows, all, unit);
}

static int add_normals(struct glb_buffer *g, const float *lean, const uint32_t *row, int few, int rows, int all)
{
	float *in = mem_new(3 * (size_t)all + 1, sizeof *in);
	for (int i = 0; i < all; i++) {
		const float most = (float)fmax(most_of(lean + 3 * i, 3, 0), 1);
		for (int c = 0; c < 3; c++)
			in[3 * i + c] = lean[3 * i + c] / most;
	}
	const int accessor = add_steps(g, in, row, few, rows, all, 1, 8, false);
	free(in);
	return accessor;
}

static void append(struct glb_targets *t, const char *name, int position, int normal)
{
	json_t *target = json_pack("{s:i}", "POSITION", position), *text = json_string(name);
	if (normal >= 0)
		json_object_set_new(target, "NORMAL", json_integer(normal));
	json_array_append_new(t->list, target);
	json_array_append_new(t->names, text ? text : json_string("shape"));
}

void glb_targets_add(struct glb_targets *t, struct glb_buffer *g, const char *name, const float *by, const float *lean, int n, double unit,
                     double gain)
{
	uint32_t *row = mem_new((size_t)n + 1, sizeof *row);
	int few = 0;
	for (int i = 0; i < n; i++)
		if (!rests(by + 3 * i, unit, INT16_MAX) || (lean && !rests(lean + 3 * i, 1, INT8_MAX)))
			row[few++] = (uint32_t)i;
	if (few) {
		const int rows = glb_add_rows(g, row, few, n), position = gain > 0 ? add_steps(g, by, row, few, rows, n, unit / gain, 8, true) : add_places(g, by, row, few, rows, n, unit);
		append(t, name, position, lean ? add_normals(g, lean, row, few, rows, n) : -1);
	} else {
		glb_targets_add_zero(t, g, &name, 1, lean, n);
	}
	free(row);
}

void glb_targets_add_zero(struct glb_targets *t, struct glb_buffer *g, const char *const *names, int n_names, bool normals, int n)
{
	const int zero = n_names ? glb_add_accessor(g, json_pack("{s:i,s:i,s:s,s:[i,i,i],s:[i,i,i]}", "componentType", GLB_FLOAT, "count", n, "type", "VEC3",
	                                                         "min", 0, 0, 0, "max", 0, 0, 0)) : -1;
	for (int i = 0; i < n_names; i++)
		append(t, names[i], zero, normals ? zero : -1);
}

static bool there(const json_t *names, const char *name)
{
	const json_t *at;
	size_t i;
	json_array_foreach(names, i, at)
		if (!strcmp(json_string_value(at), name))
			return true;
	return false;
}

/* Which of the targets are driven by others, and how: for those who rig the file by hand; halves of blinks first. Null where none is. */
static json_t *driven_of(const json_t *names, const struct glb_bake *b)
{
	json_t *list = json_array();
	for (int k = 0; k < b->n_poses; k++) {
		const int pose = (k + b->n_poses - GLB_HALVES) % b->n_poses;
		const struct glb_driven *d = &b->driven[pose];
		if (d->by < 0 || !there(names, b->pose_name[pose]))
			continue;
		json_array_append_new(list, json_pack("{s:s,s:s,s:s*,s:s}", "target", b->pose_name[pose], "by", b->pose_name[d->by], "and", d->and < 0 ? 0 : b->pose_name[d->and],
		                                      "weight", d->half ? d->and < 0 ? "4 w (1 - w)" : "4 w (1 - w) v" : "w v"));
	}
	if (json_array_size(list))
		return list;
	json_decref(list);
	return 0;
}

int glb_targets_put(const struct glb_targets *t, json_t *mesh, const struct glb_bake *bake)
{
	const size_t n = json_array_size(t->list);
	json_t *primitive, *weights = json_array();
	size_t i;
	for (i = 0; i < n; i++)
		json_array_append_new(weights, json_real(0));
	if (n) {
		json_array_foreach(json_object_get(mesh, "primitives"), i, primitive)
			json_object_set(primitive, "targets", t->list);
		json_object_set(mesh, "weights", weights);
		json_object_set_new(mesh, "extras", json_pack("{s:O,s:o*}", "targetNames", t->names, "drivenTargets", driven_of(t->names, bake)));
	}
	json_decref(weights);
	return (int)n;
}
