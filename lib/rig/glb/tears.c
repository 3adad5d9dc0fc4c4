#include "rig/glb/tears.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/glb/strands.h"
#include "rig/glb/targets.h"

/* Index of tear fluid; share of an opening at each end over which the meniscus runs out; it stands off the eyeball so far, mm. */
static const double tear_index = 1.336, runs_out = 0.06, off_mm = 0.02;

int tears_count(const struct hairs *hairs)
{
	return hairs ? TEARS_SECTION * hairs->n_rims : 0;
}

static void root_of(float out[3], const struct hair_rim *rim, int lid, const float (*x)[3])
{
	for (int c = 0; c < 3; c++) {
		out[c] = 0;
		for (int k = 0; k < 3; k++)
			out[c] += rim->weight[lid][k] * x[rim->vertex[lid][k]][c];
	}
}

/* Distance of the globe's surface from its centre in a direction. */
static double surface(const struct rig *rig, int side, const double turn[3][3], const double dir[3])
{
	const struct rig_globe *g = &rig->globe[side];
	float at[3];
	for (int c = 0; c < 3; c++)
		at[c] = (float)(g->center[c] + g->radius * dir[c]);
	return g->radius - rig_globe_distance(rig, side, turn, at);
}

/* The lower lid's edge from the globe's centre, and the way over the globe to the upper one, unit and across each other. Returns how far the
 * lids are apart that way, mm; less than nothing where they overlap. */
static double between(double edge[3], double up[3], const struct hair_rim *rim, const struct rig *rig, const float (*x)[3])
{
	float low[3], high[3];
	double gap[3], head_up[3];
	root_of(low, rim, 0, x);
	root_of(high, rim, 1, x);
	for (int c = 0; c < 3; c++) {
		edge[c] = (double)low[c] - rig->globe[rim->side].center[c];
		gap[c] = (double)high[c] - (double)low[c];
		head_up[c] = rig->head_from_target[1][c];
	}
	vec_unit(edge, edge);
	vec_add(up, head_up, -vec_dot(head_up, edge), edge);
	vec_unit(up, up);
	return vec_dot(gap, up);
}

void tears_place(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct rig *rig, const float (*x)[3],
                 const double turn[2][3][3], double height, double over)
{
	for (int i = 0; i < hairs->n_rims; i++) {
		const struct hair_rim *rim = &hairs->rim[i];
		const struct rig_globe *g = &rig->globe[rim->side];
		double edge[3], up[3];
		const double open = between(edge, up, rim, rig, x), end = fmin(fmin((double)rim->along, 1 - (double)rim->along) / runs_out, 1);
		const double R = fmax(fmin(height * end, 0.5 * open), 0);
		for (int k = 0; k < TEARS_SECTION; k++) {
			const double a = 0.5 * M_PI * k / (TEARS_SECTION - 1), turned = R * (1 - cos(a)) / g->radius;
			double dir[3];
			for (int c = 0; c < 3; c++)
				dir[c] = cos(turned) * edge[c] + sin(turned) * up[c];
			const double far = surface(rig, rim->side, turn[rim->side], dir) + over + off_mm + R * (1 - sin(a));
			for (int c = 0; c < 3; c++) {
				out[TEARS_SECTION * i + k][c] = (float)(g->center[c] + far * dir[c]);
				if (normal)
					normal[TEARS_SECTION * i + k][c] = (float)(sin(a) * edge[c] + cos(a) * up[c]);
			}
		}
	}
}

void tears_rest(float (*out)[3], float (*normal)[3], const struct hairs *hairs, const struct rig *rig, double height, double over)
{
	double turn[2][3][3];
	for (int s = 0; s < 2; s++)
		rig_globe_rotation(turn[s], rig, (double[3]){ 0 });
	tears_place(out, normal, hairs, rig, (const float(*)[3])rig->rest, (const double(*)[3][3])turn, height, over);
}

int tears_faces(uint32_t (*face)[3], const struct hairs *hairs, uint32_t first)
{
	int n = 0;
	for (int i = 0; i + 1 < hairs->n_rims; i++)
		for (uint32_t k = 0; k + 1 < TEARS_SECTION && hairs->rim[i].side == hairs->rim[i + 1].side; k++) {
			// From the nose outwards: the right eye's run the other way.
			const uint32_t at = first + (uint32_t)(TEARS_SECTION * i) + k, a = hairs->rim[i].side ? at + TEARS_SECTION : at, b = hairs->rim[i].side ? at : at + TEARS_SECTION;
			memcpy(face[n++], (uint32_t[]){ a, b, a + 1 }, sizeof *face);
			memcpy(face[n++], (uint32_t[]){ b, b + 1, a + 1 }, sizeof *face);
		}
	return n;
}

json_t *tears_material(void)
{
	return json_pack("{s:s,s:{s:[f,f,f,f],s:f,s:f},s:{s:{s:f},s:{s:f}}}", "name", "tears", "pbrMetallicRoughness", "baseColorFactor", 1.0, 1.0, 1.0, 1.0,
	                 "metallicFactor", 0.0, "roughnessFactor", 0.02, "extensions", "KHR_materials_transmission", "transmissionFactor", 1.0,
	                 "KHR_materials_ior", "ior", tear_index);
}

static void name_once(json_t *used, const char *name)
{
	size_t i;
	json_t *there;
	json_array_foreach(used, i, there)
		if (!strcmp(json_string_value(there), name))
			return;
	json_array_append_new(used, json_string(name));
}

void tears_put(struct glb_skin *skin, struct glb_buffer *g, const struct rig *rig, const struct glb_bake *b, const struct glb_conf *conf, json_t *used)
{
	const int n = tears_count(conf->hairs);
	if (!n || !(conf->tear_mm > 0))
		return;
	float (*x)[3] = mem_array((size_t)n, sizeof *x), (*normal)[3] = mem_array((size_t)n, sizeof *normal);
	uint32_t (*face)[3] = mem_new(2 * (size_t)n + 1, sizeof *face);
	tears_rest(x, normal, conf->hairs, rig, conf->tear_mm, conf->over_mm);
	json_array_append_new(skin->materials, tears_material());
	name_once(used, "KHR_materials_ior");
	name_once(used, "KHR_materials_transmission");
	const int n_faces = tears_faces(face, conf->hairs, 0);
	strands_put_mesh(skin, g, b, "tears", strands_count(conf->hairs), n, (const float(*)[3])x, (const float(*)[3])normal, (const uint32_t(*)[3])face, n_faces);
	free(x);
	free(normal);
	free(face);
}
