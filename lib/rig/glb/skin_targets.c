#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/glb/arkit.h"
#include "rig/glb/skin_impl.h"

/* The rows of a part that move, of the bake's x[bake.n][3]: out[part.n][3]; others are zero. */
static void rows_of(float *out, const struct maker *m, const struct part *p, const float *x)
{
	memset(out, 0, 3 * (size_t)p->n * sizeof *out);
	for (int i = 0; i < p->n; i++)
		if (m->moving[p->vertex[i]] >= 0)
			memcpy(out + 3 * i, x + 3 * (size_t)m->moving[p->vertex[i]], 3 * sizeof *out);
}

bool skin_put_ours(struct maker *m, struct part *p)
{
	const struct glb_bake *b = m->bake;
	const size_t row = 3 * (size_t)b->n;
	bool moves = false;
	for (int i = 0; i < p->n && !moves; i++)
		moves = m->moving[p->vertex[i]] >= 0;
	if (!moves)
		return false;
	float *by = mem_new(3 * (size_t)p->n + 1, sizeof *by), *lean = mem_new(3 * (size_t)p->n + 1, sizeof *lean);
	for (int k = 0; k < b->n_targets + b->n_poses; k++) {
		const int pose = k - b->n_targets;
		char name[32];
		snprintf(name, sizeof name, "motion_%02d", k + 1);
		rows_of(by, m, p, pose < 0 ? b->target + (size_t)k * row : b->pose + (size_t)pose * row);
		rows_of(lean, m, p, pose < 0 ? b->lean + (size_t)k * row : b->pose_lean + (size_t)pose * row);
		glb_targets_add(&p->targets, m->g, pose < 0 ? name : b->pose_name[pose], by, lean, p->n, m->unit, 0);
	}
	free(by);
	free(lean);
	return b->n_targets + b->n_poses > 0;
}

static bool has_name(const struct part *p, const char *name)
{
	size_t i;
	json_t *at;
	json_array_foreach(p->targets.names, i, at)
		if (!strcmp(json_string_value(at), name))
			return true;
	return false;
}

/* How a blend shape moves every vertex of the rig: what was added to the mesh goes with those that it follows. free(). */
static float (*shaped(const struct maker *m, int shape, bool *moved))[3]
{
	const struct look *l = m->look;
	const struct rig_weights *follows = &m->rig->bplus;
	float (*by)[3] = mem_new((size_t)m->rig->n + 1, sizeof *by);
	for (int k = l->shape_start[shape]; k < l->shape_start[shape + 1]; k++) {
		memcpy(by[l->shape_point[k]], l->shape_by[k], sizeof *by);
		moved[l->shape_point[k]] = true;
	}
	for (int i = rig_own_vertices(m->rig); i < m->rig->n; i++)
		for (int j = follows->start[i]; j < follows->start[i + 1]; j++) {
			moved[i] = moved[i] || moved[follows->column[j]];
			for (int c = 0; c < 3; c++)
				by[i][c] += follows->weight[j] * by[follows->column[j]][c];
		}
	return by;
}

/* The normals of the surface with a blend shape at weight 1. */
static float (*shaped_normals(const struct maker *m, const float (*by)[3]))[3]
{
	float (*x)[3] = mem_array((size_t)m->rig->n + 1, sizeof *x);
	for (int i = 0; i < 3 * m->rig->n; i++)
		x[i / 3][i % 3] = m->rig->rest[i / 3][i % 3] + by[i / 3][i % 3];
	const struct mesh mesh = { m->rig->n, m->rig->n_faces, x, m->rig->faces, 0 };
	float (*normal)[3] = mesh_normals(&mesh);
	free(x);
	return normal;
}

void skin_put_own(struct maker *m, struct part *parts, int n_parts, int shape)
{
	const struct look *l = m->look;
	bool *moved = mem_new((size_t)m->rig->n + 1, sizeof *moved);
	float (*all)[3] = shaped(m, shape, moved), (*normal)[3] = shaped_normals(m, (const float(*)[3])all);
	for (int i = 0; i < n_parts; i++) {
		struct part *p = &parts[i];
		float *by = mem_new(3 * (size_t)p->n + 1, sizeof *by), *lean = mem_new(3 * (size_t)p->n + 1, sizeof *lean);
		bool moves = false;
		for (int v = 0; v < p->n; v++) {
			const int k = p->vertex[v];
			for (int c = 0; c < 3 && moved[k]; c++) {
				by[3 * v + c] = all[k][c];
				lean[3 * v + c] = normal[k][c] - m->rest[k][c];
			}
			moves = moves || moved[k];
		}
		if (moves) {
			char *name = has_name(p, l->shape[shape]) ? mem_printf("%s.own", l->shape[shape]) : mem_str(l->shape[shape]);
			glb_targets_add(&p->targets, m->g, name, by, lean, p->n, m->unit, 0);
			free(name);
		}
		free(by);
		free(lean);
	}
	free(moved);
	free(all);
	free(normal);
}

void skin_put_zero(struct maker *m, struct part *p)
{
	const char *names[ARKIT_SHAPES];
	int n = 0;
	for (int i = 0; i < ARKIT_SHAPES; i++) {
		bool there = false;
		size_t k;
		json_t *name;
		json_array_foreach(p->targets.names, k, name)
			there = there || arkit_means(json_string_value(name), arkit_names[i]);
		if (!there)
			names[n++] = arkit_names[i];
	}
	for (int i = 0; i < n; i++)
		json_array_append_new(p->zero, json_string(names[i]));
	glb_targets_add_zero(&p->targets, m->g, names, n, true, p->n);
}
