#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/glb/skin_impl.h"

/* range: places, in the file's unit. */
static int add_rows(struct maker *m, const struct part *p, int width, bool range, const float *(*at)(const struct maker *, const struct part *, int))
{
	float *x = mem_new((size_t)width * (size_t)p->n + 1, sizeof *x);
	for (int i = 0; i < p->n; i++)
		memcpy(x + (size_t)width * (size_t)i, at(m, p, i), (size_t)width * sizeof *x);
	for (int i = 0; range && i < width * p->n; i++)
		x[i] = (float)(x[i] / m->unit);
	const int accessor = glb_add_floats(m->g, x, (size_t)p->n, width, range, GLB_ARRAY);
	free(x);
	return accessor;
}

static const float *place_of(const struct maker *m, const struct part *p, int i) { return m->rig->rest[p->vertex[i]]; }
static const float *normal_of(const struct maker *m, const struct part *p, int i)
{
	return m->look ? m->look->normal[p->wedge[i]] : m->rig->normal[p->vertex[i]];
}
static const float *uv_of(const struct maker *m, const struct part *p, int i) { return m->look->uv[p->wedge[i]]; }
static const float *rgba_of(const struct maker *m, const struct part *p, int i) { return m->look->rgba[p->wedge[i]]; }

static bool is_coloured(const struct maker *m, const struct part *p)
{
	for (int i = 0; m->look && i < p->n; i++)
		for (int c = 0; c < 4; c++)
			if (m->look->rgba[p->wedge[i]][c] != 1)
				return true;
	return false;
}

/* Tangents along u, and the side of the bitangent, which points towards smaller v as glTF has it: [n][4]. free(). */
static float (*tangents(const struct maker *m, const struct part *p, int n_faces, const uint32_t (*corner)[3]))[4]
{
	float (*out)[4] = mem_new((size_t)p->n + 1, sizeof *out), (*up)[3] = mem_new((size_t)p->n + 1, sizeof *up);
	for (int f = 0; f < n_faces; f++) {
		const uint32_t *v = corner[f];
		const float *x[3], *t[3];
		for (int k = 0; k < 3; k++) {
			x[k] = place_of(m, p, (int)v[k]);
			t[k] = uv_of(m, p, (int)v[k]);
		}
		const float a = t[1][0] - t[0][0], b = t[1][1] - t[0][1], c = t[2][0] - t[0][0], d = t[2][1] - t[0][1], area = a * d - b * c;
		const float side = area > 0 ? 1 : area < 0 ? -1 : 0;  // the gradient's direction, weighted by the area in space
		for (int k = 0; k < 3; k++)
			for (int i = 0; i < 3; i++) {
				out[v[k]][i] += side * (d * (x[1][i] - x[0][i]) - b * (x[2][i] - x[0][i]));
				up[v[k]][i] -= side * (a * (x[2][i] - x[0][i]) - c * (x[1][i] - x[0][i]));
			}
	}
	for (int i = 0; i < p->n; i++) {
		const float *n = normal_of(m, p, i);
		float *t = out[i], along = t[0] * n[0] + t[1] * n[1] + t[2] * n[2], len = 0;
		for (int c = 0; c < 3; c++) {
			t[c] -= along * n[c];
			len += t[c] * t[c];
		}
		if (!(len > 1e-20f)) {
			const int least = fabsf(n[0]) < fabsf(n[1]) ? fabsf(n[0]) < fabsf(n[2]) ? 0 : 2 : fabsf(n[1]) < fabsf(n[2]) ? 1 : 2;
			len = 0;
			for (int c = 0; c < 3; c++) {
				t[c] = (c == least) - n[least] * n[c];
				len += t[c] * t[c];
			}
		}
		for (int c = 0; c < 3; c++)
			t[c] /= sqrtf(len);
		const float cross[3] = { n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0] };
		t[3] = cross[0] * up[i][0] + cross[1] * up[i][1] + cross[2] * up[i][2] < 0 ? -1 : 1;
	}
	free(up);
	return out;
}

/* Whether a material of the part has a normal map. */
static bool is_bumpy(const struct maker *m, int n_faces, const int *material)
{
	for (int f = 0; m->look && m->look->has_uv && f < n_faces; f++)
		if (material[f] < m->look->n_materials && m->look->material[material[f]].map[LOOK_NORMAL] >= 0)
			return true;
	return false;
}

void skin_put_primitives(struct maker *m, struct part *p, int n_faces, const uint32_t (*corner)[3], const int *material, int n_materials)
{
	json_t *attributes = json_object();
	json_object_set_new(attributes, "POSITION", json_integer(add_rows(m, p, 3, true, place_of)));
	json_object_set_new(attributes, "NORMAL", json_integer(add_rows(m, p, 3, false, normal_of)));
	if (m->look && m->look->has_uv)
		json_object_set_new(attributes, "TEXCOORD_0", json_integer(add_rows(m, p, 2, false, uv_of)));
	if (is_bumpy(m, n_faces, material)) {
		float (*t)[4] = tangents(m, p, n_faces, corner);
		json_object_set_new(attributes, "TANGENT", json_integer(glb_add_floats(m->g, &t[0][0], (size_t)p->n, 4, false, GLB_ARRAY)));
		free(t);
	}
	if (is_coloured(m, p))
		json_object_set_new(attributes, "COLOR_0", json_integer(add_rows(m, p, 4, false, rgba_of)));
	uint32_t (*of)[3] = mem_new((size_t)n_faces + 1, sizeof *of);
	for (int k = 0; k < n_materials; k++) {
		size_t n = 0;
		for (int f = 0; f < n_faces; f++)
			if (material[f] == k)
				memcpy(of[n++], corner[f], sizeof *of);
		if (!n)
			continue;
		const int index = glb_add_corners(m->g, of[0], 3 * n, p->n);
		json_array_append_new(p->primitives, json_pack("{s:O,s:i,s:i}", "attributes", attributes, "indices", index, "material", k));
	}
	json_decref(attributes);
	free(of);
}
