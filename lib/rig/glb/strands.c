#include "rig/glb/strands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/glb/targets.h"

enum { TUBE = 3, RIBBON = 2 };
static const float tube = 1.2092f;  // radius of the circle round a triangle that is as wide as a round hair, in the mean over where it is seen from: 2 pi / (3 sqrt 3)

static int sides_of(const struct hair *h)
{
	return h->kind == HAIR_BROW ? RIBBON : TUBE;
}

/* A ring at every point but the last, which is the tip. */
static int vertices_of(const struct hair *h)
{
	return sides_of(h) * (h->n - 1) + 1;
}

int strands_count(const struct hairs *hairs)
{
	int n = 0;
	for (int i = 0; hairs && i < hairs->n; i++)
		n += vertices_of(&hairs->hair[i]);
	return n;
}

/* Two axes across the hair at a point, a x b = way. A ribbon lies across the way off the skin. */
static void across(float a[3], float b[3], const float way[3], const struct hair_frame *f, bool ribbon)
{
	if (ribbon)
		vecf_cross(a, f->off, way);
	else
		vecf_cross(a, way, f->along);
	vecf_unit(a);
	vecf_cross(b, way, a);
}

static void one(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct hair *h, const struct rig *rig, const float (*x)[3])
{
	const struct hair_frame f = hair_frame_of(h, rig, x);
	const int sides = sides_of(h);
	float point[HAIR_LASH_POINTS][3], way[3], a[3], b[3];
	hair_place(point, hairs, h, rig, x);
	for (int k = 0, row = 0; k < h->n; k++) {
		const bool tip = k + 1 == h->n, ribbon = sides == RIBBON;
		for (int c = 0; c < 3; c++)
			way[c] = point[tip ? k : k + 1][c] - point[k ? k - 1 : 0][c];
		vecf_unit(way);
		across(a, b, way, &f, ribbon);
		for (int i = 0; i < (tip ? 1 : sides); i++, row++)
			for (int c = 0; c < 3; c++) {
				const float turn = 2 * (float)M_PI * (float)i / (float)sides, side = cosf(turn) * a[c] + sinf(turn) * b[c];
				out[row][c] = point[k][c] + (tip ? 0 : (ribbon ? 1 : tube) * hair_half(h, k) * side);
				if (normal)
					normal[row][c] = ribbon ? b[c] : tip ? way[c] : side;
			}
	}
}

void strands_place(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct rig *rig, const float (*x)[3])
{
	int row = 0;
	for (int i = 0; i < hairs->n; i++) {
		one(out + row, normal ? normal + row : 0, hairs, &hairs->hair[i], rig, x);
		row += vertices_of(&hairs->hair[i]);
	}
}

/* Triangles of a hair whose vertices begin at `first`; returns how many. */
static int triangles(uint32_t (*face)[3], const struct hair *h, uint32_t first)
{
	const uint32_t sides = (uint32_t)sides_of(h), rings = (uint32_t)h->n - 1, walls = sides == RIBBON ? 1 : sides, tip = first + sides * rings;
	int n = 0;
	for (uint32_t k = 0; k < rings; k++)
		for (uint32_t i = 0; i < walls; i++) {
			const uint32_t p = first + k * sides + i, q = first + k * sides + (i + 1) % sides;
			memcpy(face[n++], (uint32_t[]){ p, q, k + 1 < rings ? p + sides : tip }, sizeof *face);
			if (k + 1 < rings)
				memcpy(face[n++], (uint32_t[]){ q, q + sides, p + sides }, sizeof *face);
		}
	return n;
}

/* n rows of x over `unit` as an accessor. */
static int places(struct glb_buffer *g, const float *x, int n, double unit)
{
	float *out = mem_array(3 * (size_t)n, sizeof *out);
	for (int i = 0; i < 3 * n; i++)
		out[i] = (float)(x[i] / unit);
	const int accessor = glb_add_floats(g, out, (size_t)n, 3, true, GLB_ARRAY);
	free(out);
	return accessor;
}

/* All of the bake's targets for rows [first, first + n). gain: [b->n_targets] out. */
static struct glb_targets targets_of(double *gain, struct glb_buffer *g, const struct glb_bake *b, int first, int n, double unit)
{
	struct glb_targets targets = glb_targets_new();
	double *most = mem_new((size_t)b->n_targets + 1, sizeof *most);
	for (int k = 0; k < b->n_targets; k++)
		for (int i = 0; i < 3 * n; i++)
			most[k] = fmax(most[k], fabs((double)b->hair_target[3 * ((size_t)b->n_hair * (size_t)k + (size_t)first) + (size_t)i]));
	glb_targets_small(gain, most, b->n_targets, unit);
	free(most);
	for (int k = 0; k < b->n_targets + b->n_poses; k++) {
		const int pose = k - b->n_targets;
		const float *x = pose < 0 ? b->hair_target + 3 * (size_t)b->n_hair * (size_t)k : b->hair_pose + 3 * (size_t)b->n_hair * (size_t)pose;
		char name[32];
		snprintf(name, sizeof name, "motion_%02d", k + 1);
		glb_targets_add(&targets, g, pose < 0 ? name : b->pose_name[pose], x + 3 * first, 0, n, unit, pose < 0 ? gain[k] : 0);
	}
	return targets;
}

void strands_put_mesh(struct glb_skin *skin, struct glb_buffer *g, const struct glb_bake *b, const char *name, int first, int n, const float (*x)[3],
                      const float (*normal)[3], const uint32_t (*face)[3], int n_faces)
{
	const int position = places(g, x[0], n, skin->unit), off = glb_add_normals(g, normal, (size_t)n);
	const int index = glb_add_corners(g, face[0], 3 * (size_t)n_faces, n), material = (int)json_array_size(skin->materials) - 1;
	json_t *mesh = json_pack("{s:s,s:[{s:{s:i,s:i},s:i,s:i}]}", "name", name, "primitives", "attributes", "POSITION", position, "NORMAL", off,
	                         "indices", index, "material", material);
	double *gain = skin->gain[skin->n] = mem_new((size_t)b->n_targets + 1, sizeof *gain);
	struct glb_targets targets = targets_of(gain, g, b, first, n, skin->unit);
	skin->ours[skin->n] = b->n_targets > 0;
	skin->all[skin->n++] = glb_targets_put(&targets, mesh, b);
	json_array_append_new(skin->meshes, mesh);
	glb_targets_free(&targets);
}

int strands_faces(uint32_t (*face)[3], const struct hairs *hairs, int from, int to)
{
	int n = 0, n_faces = 0;
	for (int i = from; i < to; i++) {
		n_faces += triangles(face + n_faces, &hairs->hair[i], (uint32_t)n);
		n += vertices_of(&hairs->hair[i]);
	}
	return n_faces;
}

json_t *strands_material(const double rgb[3])
{
	return json_pack("{s:s,s:b,s:{s:[f,f,f,f],s:f,s:f}}", "name", "hair", "doubleSided", 1, "pbrMetallicRoughness", "baseColorFactor", rgb[0], rgb[1], rgb[2], 1.0,
	                 "metallicFactor", 0.0, "roughnessFactor", 0.6);
}

int strands_most_faces(const struct hairs *hairs)
{
	return 2 * TUBE * hairs->n_points;
}

void strands_put(struct glb_skin *skin, struct glb_buffer *g, const struct rig *rig, const struct glb_bake *b, const struct hairs *hairs, const double rgb[3])
{
	const int n = strands_count(hairs);
	int brows = 0, first = 0;
	if (!n)
		return;
	for (; brows < hairs->n && hairs->hair[brows].kind != HAIR_BROW; brows++)
		first += vertices_of(&hairs->hair[brows]);
	float (*x)[3] = mem_array((size_t)n, sizeof *x), (*normal)[3] = mem_array((size_t)n, sizeof *normal);
	uint32_t (*face)[3] = mem_new((size_t)strands_most_faces(hairs) + 1, sizeof *face);
	strands_place(x, normal, hairs, rig, (const float(*)[3])rig->rest);
	json_array_append_new(skin->materials, strands_material(rgb));
	for (int k = 0; k < 2; k++) {
		const int from = k ? first : 0, to = k ? n : first, n_faces = strands_faces(face, hairs, k ? brows : 0, k ? hairs->n : brows);
		if (k && hairs->brow_rgb[1] > 0)
			json_array_append_new(skin->materials, strands_material(hairs->brow_rgb));
		if (to > from)
			strands_put_mesh(skin, g, b, k ? "brows" : "lashes", from, to - from, (const float(*)[3])x + from, (const float(*)[3])normal + from, (const uint32_t(*)[3])face, n_faces);
	}
	free(x);
	free(normal);
	free(face);
}
