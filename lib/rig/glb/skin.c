#include "rig/glb/skin.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/glb/skin_impl.h"

/* Whether a face is shown: not one of the eyeballs, which the exported eyes replace. */
static bool is_skin(const struct rig *rig, const int32_t face[3])
{
	return !rig_is_globe(rig->part[face[0]]) && !rig_is_globe(rig->part[face[1]]) && !rig_is_globe(rig->part[face[2]]);
}

/* The faces of one mesh of the character, all of them where `of` is below 0. Returns false where none is shown. LINING: what the character has not
 * of its own, with the second material that none of its faces has. */
enum { ALL = -1, LINING = -2 };
static bool put_part(struct maker *m, struct part *p, int of)
{
	const struct look *l = m->look;
	const int rows = l ? l->n_wedges : m->rig->n, own = rig_own_faces(m->rig), none = of == LINING ? m->plain + 1 : m->plain;
	int *row = mem_array((size_t)rows + 1, sizeof *row), n_faces = 0, *material = mem_new((size_t)m->rig->n_faces + 1, sizeof *material);
	uint32_t (*corner)[3] = mem_new((size_t)m->rig->n_faces + 1, sizeof *corner);
	*p = (struct part){ .name = of == LINING ? "lining" : l ? l->part[of] : "skin", .primitives = json_array(), .targets = glb_targets_new(), .zero = json_array() };
	p->vertex = mem_new((size_t)rows + 1, sizeof *p->vertex);
	p->wedge = mem_new((size_t)rows + 1, sizeof *p->wedge);
	for (int i = 0; i < rows; i++)
		row[i] = -1;
	for (int f = 0; f < m->rig->n_faces; f++) {
		if ((f < own) == (of == LINING) || !is_skin(m->rig, m->rig->faces[f]) || (l && l->face_part[f] != of))
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
		skin_put_primitives(m, p, n_faces, (const uint32_t(*)[3])corner, material, none + 1);
	free(row);
	free(corner);
	free(material);
	return n_faces > 0;
}

static void part_free(struct part *p)
{
	json_decref(p->primitives);
	glb_targets_free(&p->targets);
	json_decref(p->zero);
	free(p->vertex);
	free(p->wedge);
}

static json_t *mesh_of(const struct part *p, const struct glb_bake *bake)
{
	json_t *name = json_string(p->name);
	json_t *mesh = json_pack("{s:o,s:O}", "name", name ? name : json_string("mesh"), "primitives", p->primitives);
	glb_targets_put(&p->targets, mesh, bake);
	if (json_array_size(p->zero))
		json_object_set(json_object_get(mesh, "extras"), "zeroTargets", p->zero);
	return mesh;
}

void glb_skin_make(struct glb_skin *skin, struct glb_buffer *g, const struct rig *rig, const struct glb_bake *bake,
                   const struct glb_conf *conf, const struct look *look)
{
	const struct mesh mesh = { rig->n, rig->n_faces, rig->rest, rig->faces, 0 };
	struct maker m = { g, rig, bake, look, look ? look->n_materials : 0, glb_unit(bake, look), mem_array((size_t)rig->n + 1, sizeof *m.moving), mesh_normals(&mesh) };
	const int most = (look ? look->n_parts : 1) + 1;
	struct part *parts = mem_new((size_t)most + 1, sizeof *parts);
	*skin = (struct glb_skin){ .unit = m.unit, .meshes = json_array(), .ours = mem_new((size_t)most + 4, sizeof(int)), .all = mem_new((size_t)most + 4, sizeof(int)), .gain = mem_new((size_t)most + 4, sizeof(double *)) };
	for (int i = 0; i < rig->n; i++)
		m.moving[i] = -1;
	for (int i = 0; i < bake->n; i++)
		m.moving[bake->vertex[i]] = i;
	int face = 0, busiest = -1;
	for (int i = 0; i < most; i++) {
		struct part *p = &parts[skin->n];
		const bool lining = i == most - 1;
		m.look = lining ? 0 : look;
		if (!put_part(&m, p, lining ? LINING : look ? i : ALL)) {
			part_free(p);
			continue;
		}
		skin->ours[skin->n] = skin_put_ours(&m, p);
		int moves = 0;
		for (int v = 0; v < p->n; v++)
			moves += m.moving[p->vertex[v]] >= 0;
		face = moves > busiest && !lining ? skin->n : face;
		busiest = moves > busiest && !lining ? moves : busiest;
		skin->n++;
	}
	m.look = look;
	for (int s = 0; look && s < look->n_shapes; s++)
		skin_put_own(&m, parts, skin->n, s);
	if (bake->n_poses && skin->n)
		skin_put_zero(&m, &parts[face]);
	for (int i = 0; i < skin->n; i++) {
		skin->all[i] = (int)json_array_size(parts[i].targets.list);
		json_array_append_new(skin->meshes, mesh_of(&parts[i], bake));
		part_free(&parts[i]);
	}
	skin_put_materials(skin, g, look, rig_own_faces(rig) < rig->n_faces, conf);
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
	for (int i = 0; i < skin->n; i++)
		free(skin->gain[i]);
	free(skin->gain);
	free(skin->ours);
	free(skin->all);
}
