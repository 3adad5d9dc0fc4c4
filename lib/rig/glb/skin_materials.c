#include "rig/glb/skin_impl.h"

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

/* Linear: what draw/face draws lining with, and about as rough as what is wet looks. */
static const double mucosa_rgb[3] = { 0.56, 0.27, 0.24 }, mucosa_rough = 0.25;

void skin_put_materials(struct glb_skin *skin, struct glb_buffer *g, const struct look *l, bool lining, const struct glb_conf *conf)
{
	skin->materials = json_array();
	for (int i = 0; l && i < l->n_materials; i++)
		json_array_append_new(skin->materials, material_of(&l->material[i]));
	json_array_append_new(skin->materials, plain_material("skin", conf->skin_rgb, 0.55));
	if (lining) {
		json_t *both = plain_material("lining", mucosa_rgb, mucosa_rough);
		json_object_set_new(both, "doubleSided", json_true());
		json_array_append_new(skin->materials, both);
	}
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
