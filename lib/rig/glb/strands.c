#include "rig/glb/strands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

static const float metres = 1e-3f;
enum { TUBE = 3, RIBBON = 2 };

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
				out[row][c] = point[k][c] + (tip ? 0 : hair_half(h, k) * side);
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

/* Rows [first, first + n) of x as an accessor, in metres where they are places. */
static int rows(struct glb_buffer *g, const float *x, int first, int n, float unit_of, bool range, int target)
{
	float *out = mem_array(3 * (size_t)n, sizeof *out);
	for (int i = 0; i < 3 * n; i++)
		out[i] = unit_of * x[3 * first + i];
	const int accessor = glb_add_floats(g, out, (size_t)n, 3, range, target);
	free(out);
	return accessor;
}

/* All of the bake's targets for rows [first, first + n), with their names. */
static json_t *targets_of(json_t *names, struct glb_buffer *g, const struct glb_bake *b, int first, int n)
{
	json_t *targets = json_array();
	const int poses = b->pose ? GLB_POSES : 0;
	for (int k = 0; k < b->n_targets + poses; k++) {
		const bool ours = k < b->n_targets;
		const float *x = (ours ? b->hair_target : b->hair_pose) + 3 * (size_t)b->n_hair * (size_t)(ours ? k : k - b->n_targets);
		char name[32];
		snprintf(name, sizeof name, "motion_%02d", k + 1);
		json_array_append_new(targets, json_pack("{s:i}", "POSITION", rows(g, x, first, n, metres, true, GLB_ARRAY)));
		json_array_append_new(names, json_string(ours ? name : glb_pose_names[k - b->n_targets]));
	}
	return targets;
}

struct rest {
	float (*x)[3], (*normal)[3];
};

/* The hairs [from, to), whose vertices begin at `first`, as one mesh. Returns how many vertices they have. */
static int put_mesh(struct glb_skin *skin, struct glb_buffer *g, const struct glb_bake *b, const struct hairs *hairs, const struct rest *rest, const char *name,
                    int from, int to, int first)
{
	int n = 0, n_faces = 0;
	uint32_t (*face)[3] = mem_new((size_t)(2 * TUBE * hairs->n_points) + 1, sizeof *face);
	for (int i = from; i < to; i++) {
		n_faces += triangles(face + n_faces, &hairs->hair[i], (uint32_t)n);
		n += vertices_of(&hairs->hair[i]);
	}
	if (n) {
		const int position = rows(g, &rest->x[0][0], first, n, metres, true, GLB_ARRAY), normal = rows(g, &rest->normal[0][0], first, n, 1, false, GLB_ARRAY);
		const int view = glb_add_view(g, face, (size_t)n_faces * sizeof *face, GLB_INDICES), material = (int)json_array_size(skin->materials) - 1;
		const int index = glb_add_accessor(g, json_pack("{s:i,s:i,s:i,s:s}", "bufferView", view, "componentType", GLB_UINT, "count", 3 * n_faces, "type", "SCALAR"));
		json_t *names = json_array(), *weights = json_array(), *targets = targets_of(names, g, b, first, n);
		json_t *mesh = json_pack("{s:s,s:[{s:{s:i,s:i},s:i,s:i}]}", "name", name, "primitives", "attributes", "POSITION", position, "NORMAL", normal,
		                         "indices", index, "material", material);
		skin->ours[skin->n] = b->n_targets > 0;
		skin->all[skin->n++] = (int)json_array_size(targets);
		for (size_t i = 0; i < json_array_size(targets); i++)
			json_array_append_new(weights, json_real(0));
		if (json_array_size(targets)) {
			json_object_set(json_array_get(json_object_get(mesh, "primitives"), 0), "targets", targets);
			json_object_set(mesh, "weights", weights);
			json_object_set_new(mesh, "extras", json_pack("{s:O}", "targetNames", names));
		}
		json_array_append_new(skin->meshes, mesh);
		json_decref(targets);
		json_decref(weights);
		json_decref(names);
	}
	free(face);
	return n;
}

void strands_put(struct glb_skin *skin, struct glb_buffer *g, const struct rig *rig, const struct glb_bake *b, const struct hairs *hairs, const double rgb[3])
{
	const int n = strands_count(hairs);
	int brows = 0;
	if (!n)
		return;
	while (brows < hairs->n && hairs->hair[brows].kind != HAIR_BROW)
		brows++;
	const struct rest rest = { mem_array((size_t)n, sizeof *rest.x), mem_array((size_t)n, sizeof *rest.normal) };
	strands_place(rest.x, rest.normal, hairs, rig, (const float(*)[3])rig->rest);
	json_array_append_new(skin->materials, json_pack("{s:s,s:b,s:{s:[f,f,f,f],s:f,s:f}}", "name", "hair", "doubleSided", 1, "pbrMetallicRoughness",
	                                                 "baseColorFactor", rgb[0], rgb[1], rgb[2], 1.0, "metallicFactor", 0.0, "roughnessFactor", 0.6));
	const int first = put_mesh(skin, g, b, hairs, &rest, "lashes", 0, brows, 0);
	put_mesh(skin, g, b, hairs, &rest, "brows", brows, hairs->n, first);
	free(rest.x);
	free(rest.normal);
}
