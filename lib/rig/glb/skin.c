#include "rig/glb/skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/glb/arkit.h"

static const double metres = 1e-3;

/* One mesh of the file on its way: its rows are wedges of the look, or vertices of the rig where that has none. */
struct part {
	int n, *vertex, *wedge;    // [n] rows of the rig and of the look
	const char *name;
	json_t *primitives, *targets, *names, *zero;
};

/* What its targets are made from. */
struct maker {
	struct glb_buffer *g;
	const struct rig *rig;
	const struct glb_bake *bake;
	const struct look *look;
	int *moving;               // [rig.n] row of the bake; -1: it does not move
	float (*rest)[3];          // [rig.n] normals of the surface at rest
};

static void add_target(struct part *p, const char *name, int position, int normal)
{
	json_array_append_new(p->targets, json_pack("{s:i,s:i}", "POSITION", position, "NORMAL", normal));
	json_array_append_new(p->names, json_string(name));
}

/* The animation's targets and the named poses. Returns whether any vertex of the part moves. */
static bool put_ours(struct maker *m, struct part *p)
{
	const struct glb_bake *b = m->bake;
	const int poses = b->pose ? GLB_POSES : 0;
	int few = 0;
	uint32_t *index = mem_new((size_t)p->n + 1, sizeof *index);
	for (int i = 0; i < p->n; i++)
		if (m->moving[p->vertex[i]] >= 0)
			index[few++] = (uint32_t)i;
	if (few && b->n_targets + poses) {
		const int view = glb_add_view(m->g, index, (size_t)few * sizeof *index, 0);
		float *by = mem_new(3 * (size_t)few, sizeof *by), *lean = mem_new(3 * (size_t)few, sizeof *lean);
		for (int k = 0; k < b->n_targets + poses; k++) {
			const size_t row = 3 * (size_t)b->n * (size_t)(k < b->n_targets ? k : k - b->n_targets);
			const float *x = (k < b->n_targets ? b->target : b->pose) + row, *n = (k < b->n_targets ? b->lean : b->pose_lean) + row;
			for (int i = 0; i < few; i++)
				for (int c = 0; c < 3; c++) {
					const size_t from = 3 * (size_t)m->moving[p->vertex[index[i]]] + (size_t)c;
					by[3 * i + c] = (float)(metres * x[from]);
					lean[3 * i + c] = n[from];
				}
			char name[32];
			snprintf(name, sizeof name, "motion_%02d", k + 1);
			const int position = glb_add_sparse(m->g, by, few, view, p->n, true), normal = glb_add_sparse(m->g, lean, few, view, p->n, false);
			add_target(p, k < b->n_targets ? name : glb_pose_names[k - b->n_targets], position, normal);
		}
		free(by);
		free(lean);
	}
	free(index);
	return json_array_size(p->targets) > 0;
}

static bool has_name(const struct part *p, const char *name)
{
	size_t i;
	json_t *at;
	json_array_foreach(p->names, i, at)
		if (!strcmp(json_string_value(at), name))
			return true;
	return false;
}

/* The normals of the surface with a blend shape at weight 1. */
static float (*shaped_normals(const struct maker *m, int shape))[3]
{
	const struct look *l = m->look;
	float (*x)[3] = mem_array((size_t)m->rig->n + 1, sizeof *x);
	memcpy(x, m->rig->rest, (size_t)m->rig->n * sizeof *x);
	for (int k = l->shape_start[shape]; k < l->shape_start[shape + 1]; k++)
		for (int c = 0; c < 3; c++)
			x[l->shape_point[k]][c] += l->shape_by[k][c];
	const struct mesh mesh = { m->rig->n, m->rig->n_faces, x, m->rig->faces, 0 };
	float (*normal)[3] = mesh_normals(&mesh);
	free(x);
	return normal;
}

/* A blend shape of the character's own on those meshes that it moves. */
static void put_own(struct maker *m, struct part *parts, int n_parts, int shape)
{
	const struct look *l = m->look;
	int *row = mem_array((size_t)m->rig->n + 1, sizeof *row);
	float (*normal)[3] = shaped_normals(m, shape);
	for (int i = 0; i < m->rig->n; i++)
		row[i] = -1;
	for (int k = l->shape_start[shape]; k < l->shape_start[shape + 1]; k++)
		row[l->shape_point[k]] = k;
	for (int i = 0; i < n_parts; i++) {
		struct part *p = &parts[i];
		uint32_t *index = mem_new((size_t)p->n + 1, sizeof *index);
		float *by = mem_new(3 * (size_t)p->n + 1, sizeof *by), *lean = mem_new(3 * (size_t)p->n + 1, sizeof *lean);
		int few = 0;
		for (int v = 0; v < p->n; v++) {
			const int k = row[p->vertex[v]];
			if (k < 0)
				continue;
			for (int c = 0; c < 3; c++) {
				by[3 * few + c] = (float)(metres * l->shape_by[k][c]);
				lean[3 * few + c] = normal[p->vertex[v]][c] - m->rest[p->vertex[v]][c];
			}
			index[few++] = (uint32_t)v;
		}
		if (few) {
			const int view = glb_add_view(m->g, index, (size_t)few * sizeof *index, 0);
			char *name = has_name(p, l->shape[shape]) ? mem_printf("%s.own", l->shape[shape]) : mem_str(l->shape[shape]);
			const int position = glb_add_sparse(m->g, by, few, view, p->n, true), turn = glb_add_sparse(m->g, lean, few, view, p->n, false);
			add_target(p, name, position, turn);
			free(name);
		}
		free(index);
		free(by);
		free(lean);
	}
	free(row);
	free(normal);
}

/* The names of ARKit that nothing moves: zero targets, listed. */
static void put_zero(struct maker *m, struct part *p)
{
	int zero = -1;
	for (int i = 0; i < ARKIT_SHAPES; i++) {
		bool there = false;
		size_t k;
		json_t *name;
		json_array_foreach(p->names, k, name)
			there = there || arkit_means(json_string_value(name), arkit_names[i]);
		if (there)
			continue;
		if (zero < 0)
			zero = glb_add_accessor(m->g, json_pack("{s:i,s:i,s:s,s:[i,i,i],s:[i,i,i]}", "componentType", GLB_FLOAT, "count", p->n, "type", "VEC3",
			                                        "min", 0, 0, 0, "max", 0, 0, 0));
		add_target(p, arkit_names[i], zero, zero);
		json_array_append_new(p->zero, json_string(arkit_names[i]));
	}
}

static int add_rows(struct maker *m, const struct part *p, int width, bool range, const float *(*at)(const struct maker *, const struct part *, int))
{
	float *x = mem_new((size_t)width * (size_t)p->n + 1, sizeof *x);
	for (int i = 0; i < p->n; i++)
		memcpy(x + (size_t)width * (size_t)i, at(m, p, i), (size_t)width * sizeof *x);
	for (int i = 0; range && i < width * p->n; i++)
		x[i] = (float)(metres * x[i]);
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

/* Attributes of a part, and a primitive of each material in it. corner: [n_faces][3] rows of the part. */
static void put_primitives(struct maker *m, struct part *p, int n_faces, const uint32_t (*corner)[3], const int *material, int n_materials)
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
		const int view = glb_add_view(m->g, of, n * sizeof *of, GLB_INDICES);
		const int index = glb_add_accessor(m->g, json_pack("{s:i,s:i,s:i,s:s}", "bufferView", view, "componentType", GLB_UINT, "count",
		                                                   (int)(3 * n), "type", "SCALAR"));
		json_array_append_new(p->primitives, json_pack("{s:O,s:i,s:i}", "attributes", attributes, "indices", index, "material", k));
	}
	json_decref(attributes);
	free(of);
}

/* Whether a face is shown: not one of the eyeballs, which the exported eyes replace. */
static bool is_skin(const struct rig *rig, const int32_t face[3])
{
	return !rig_is_globe(rig->part[face[0]]) && !rig_is_globe(rig->part[face[1]]) && !rig_is_globe(rig->part[face[2]]);
}

/* The faces of one mesh of the character, all of them where `of` is below 0. Returns false where none is shown. */
static bool put_part(struct maker *m, struct part *p, int of)
{
	const struct look *l = m->look;
	const int rows = l ? l->n_wedges : m->rig->n, none = l ? l->n_materials : 0;
	int *row = mem_array((size_t)rows + 1, sizeof *row), n_faces = 0, *material = mem_new((size_t)m->rig->n_faces + 1, sizeof *material);
	uint32_t (*corner)[3] = mem_new((size_t)m->rig->n_faces + 1, sizeof *corner);
	*p = (struct part){ .name = l ? l->part[of] : "skin", .primitives = json_array(), .targets = json_array(), .names = json_array(), .zero = json_array() };
	p->vertex = mem_new((size_t)rows + 1, sizeof *p->vertex);
	p->wedge = mem_new((size_t)rows + 1, sizeof *p->wedge);
	for (int i = 0; i < rows; i++)
		row[i] = -1;
	for (int f = 0; f < m->rig->n_faces; f++) {
		if (!is_skin(m->rig, m->rig->faces[f]) || (l && l->face_part[f] != of))
			continue;
		for (int k = 0; k < 3; k++) {
			const int w = l ? l->corner[f][k] : m->rig->faces[f][k];
			if (row[w] < 0) {
				row[w] = p->n;
				p->vertex[p->n] = m->rig->faces[f][k];
				p->wedge[p->n++] = w;
			}
			corner[n_faces][k] = (uint32_t)row[w];
		}
		material[n_faces++] = l && l->face_material[f] >= 0 ? l->face_material[f] : none;
	}
	if (n_faces)
		put_primitives(m, p, n_faces, (const uint32_t(*)[3])corner, material, none + 1);
	free(row);
	free(corner);
	free(material);
	return n_faces > 0;
}

static void part_free(struct part *p)
{
	json_decref(p->primitives);
	json_decref(p->targets);
	json_decref(p->names);
	json_decref(p->zero);
	free(p->vertex);
	free(p->wedge);
}

static json_t *mesh_of(struct part *p)
{
	json_t *name = json_string(p->name);
	json_t *mesh = json_pack("{s:o,s:O}", "name", name ? name : json_string("mesh"), "primitives", p->primitives);
	const size_t n = json_array_size(p->targets);
	if (!n)
		return mesh;
	json_t *weights = json_array(), *primitive, *extras = json_pack("{s:O}", "targetNames", p->names);
	size_t i;
	json_array_foreach(p->primitives, i, primitive)
		json_object_set(primitive, "targets", p->targets);
	for (i = 0; i < n; i++)
		json_array_append_new(weights, json_real(0));
	if (json_array_size(p->zero))
		json_object_set(extras, "zeroTargets", p->zero);
	json_object_set_new(mesh, "weights", weights);
	json_object_set_new(mesh, "extras", extras);
	return mesh;
}

static json_t *plain_material(const char *name, const double rgb[3], double rough)
{
	return json_pack("{s:s,s:{s:[f,f,f,f],s:f,s:f}}", "name", name, "pbrMetallicRoughness", "baseColorFactor", rgb[0], rgb[1], rgb[2], 1.0,
	                 "metallicFactor", 0.0, "roughnessFactor", rough);
}

static json_t *material_of(const struct look_material *m)
{
	static const char *const alpha[] = { "OPAQUE", "MASK", "BLEND" };
	json_t *name = json_string(m->name), *pbr = json_pack("{s:[f,f,f,f],s:f,s:f}", "baseColorFactor", m->rgba[0], m->rgba[1], m->rgba[2], m->rgba[3],
	                                                     "metallicFactor", m->metal, "roughnessFactor", m->rough);
	json_t *o = json_pack("{s:o,s:o}", "name", name ? name : json_string("material"), "pbrMetallicRoughness", pbr);
	if (m->map[LOOK_COLOUR] >= 0)
		json_object_set_new(pbr, "baseColorTexture", json_pack("{s:i}", "index", m->map[LOOK_COLOUR]));
	if (m->map[LOOK_ROUGH] >= 0)
		json_object_set_new(pbr, "metallicRoughnessTexture", json_pack("{s:i}", "index", m->map[LOOK_ROUGH]));
	if (m->map[LOOK_NORMAL] >= 0)
		json_object_set_new(o, "normalTexture", json_pack("{s:i,s:f}", "index", m->map[LOOK_NORMAL], "scale", m->normal_scale));
	if (m->map[LOOK_OCCLUSION] >= 0)
		json_object_set_new(o, "occlusionTexture", json_pack("{s:i}", "index", m->map[LOOK_OCCLUSION]));
	if (m->map[LOOK_GLOW] >= 0)
		json_object_set_new(o, "emissiveTexture", json_pack("{s:i}", "index", m->map[LOOK_GLOW]));
	if (m->glow[0] > 0 || m->glow[1] > 0 || m->glow[2] > 0)
		json_object_set_new(o, "emissiveFactor", json_pack("[f,f,f]", m->glow[0], m->glow[1], m->glow[2]));
	if (m->alpha != LOOK_OPAQUE)
		json_object_set_new(o, "alphaMode", json_string(alpha[m->alpha]));
	if (m->alpha == LOOK_MASK)
		json_object_set_new(o, "alphaCutoff", json_real(m->cutoff));
	if (m->two_sided)
		json_object_set_new(o, "doubleSided", json_true());
	return o;
}

static void put_materials(struct glb_skin *skin, struct glb_buffer *g, const struct look *l, const struct glb_conf *conf)
{
	skin->materials = json_array();
	for (int i = 0; l && i < l->n_materials; i++)
		json_array_append_new(skin->materials, material_of(&l->material[i]));
	json_array_append_new(skin->materials, plain_material("skin", conf->skin_rgb, 0.55));
	skin->images = json_array();
	skin->textures = json_array();
	for (int i = 0; l && i < l->n_textures; i++) {
		const struct look_texture *t = &l->texture[i];
		const int view = glb_add_view(g, t->bytes, (size_t)t->size, 0);
		json_t *name = json_string(t->name);
		json_array_append_new(skin->images, json_pack("{s:o,s:i,s:s}", "name", name ? name : json_string("texture"), "bufferView", view, "mimeType",
		                                              t->png ? "image/png" : "image/jpeg"));
		json_array_append_new(skin->textures, json_pack("{s:i}", "source", i));
	}
}

void glb_skin_make(struct glb_skin *skin, struct glb_buffer *g, const struct rig *rig, const struct glb_bake *bake,
                   const struct glb_conf *conf, const struct look *look)
{
	const struct mesh mesh = { rig->n, rig->n_faces, rig->rest, rig->faces, 0 };
	struct maker m = { g, rig, bake, look, mem_array((size_t)rig->n + 1, sizeof *m.moving), mesh_normals(&mesh) };
	const int most = look ? look->n_parts : 1;
	struct part *parts = mem_new((size_t)most + 1, sizeof *parts);
	*skin = (struct glb_skin){ .meshes = json_array(), .ours = mem_new((size_t)most + 3, sizeof(int)), .all = mem_new((size_t)most + 3, sizeof(int)) };
	for (int i = 0; i < rig->n; i++)
		m.moving[i] = -1;
	for (int i = 0; i < bake->n; i++)
		m.moving[bake->vertex[i]] = i;
	int face = 0, busiest = -1;
	for (int i = 0; i < most; i++) {
		struct part *p = &parts[skin->n];
		if (!put_part(&m, p, look ? i : -1)) {
			part_free(p);
			continue;
		}
		skin->ours[skin->n] = put_ours(&m, p);
		int moves = 0;
		for (int v = 0; v < p->n; v++)
			moves += m.moving[p->vertex[v]] >= 0;
		face = moves > busiest ? skin->n : face;
		busiest = moves > busiest ? moves : busiest;
		skin->n++;
	}
	for (int s = 0; look && s < look->n_shapes; s++)
		put_own(&m, parts, skin->n, s);
	if (bake->pose && skin->n)
		put_zero(&m, &parts[face]);
	for (int i = 0; i < skin->n; i++) {
		skin->all[i] = (int)json_array_size(parts[i].targets);
		json_array_append_new(skin->meshes, mesh_of(&parts[i]));
		part_free(&parts[i]);
	}
	put_materials(skin, g, look, conf);
	free(parts);
	free(m.moving);
	free((void *)m.rest);
}

void glb_skin_free(struct glb_skin *skin)
{
	json_decref(skin->meshes);
	json_decref(skin->materials);
	json_decref(skin->images);
	json_decref(skin->textures);
	free(skin->ours);
	free(skin->all);
}
