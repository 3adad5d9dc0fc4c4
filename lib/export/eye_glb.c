#include "export/eye_glb.h"

#include <jansson.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/version.h"
#include "draw/eye/look.h"
#include "rig/glb/buffer.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"

static const double metres = 1e-3;

static int put_metres(struct glb_buffer *g, const float (*x)[3], int n, int target)
{
	float *scaled = mem_new(3 * (size_t)n + 1, sizeof *scaled);
	for (int i = 0; i < 3 * n; i++)
		scaled[i] = (float)(metres * x[i / 3][i % 3]);
	int at = glb_add_floats(g, scaled, (size_t)n, 3, true, target);
	free(scaled);
	return at;
}

/* Positions, normals, triangles: a mesh of one primitive. */
static json_t *plain_mesh(struct glb_buffer *g, const struct export_part *p, const char *name, int material)
{
	const int position = put_metres(g, (const float(*)[3])p->x, p->n, GLB_ARRAY), normal = glb_add_floats(g, p->normal[0], (size_t)p->n, 3, false, GLB_ARRAY);
	const int index = glb_add_corners(g, p->corner, (size_t)p->n_corners, p->n);
	return json_pack("{s:s,s:[{s:{s:i,s:i},s:i,s:i}]}", "name", name, "primitives", "attributes", "POSITION", position, "NORMAL", normal, "indices", index, "material", material);
}

static json_t *mesh(struct glb_buffer *g, const struct export_part *p, int name, double pupil_mm)
{
	json_t *out = plain_mesh(g, p, export_part_names[name], name), *primitive = json_array_get(json_object_get(out, "primitives"), 0);
	json_t *attributes = json_object_get(primitive, "attributes");
	if (name != EXPORT_BACK)
		json_object_set_new(attributes, "TEXCOORD_0", json_integer(glb_add_floats(g, p->uv[0], (size_t)p->n, 2, false, GLB_ARRAY)));
	if (name == EXPORT_IRIS)
		json_object_set_new(attributes, "TANGENT", json_integer(glb_add_floats(g, p->tangent[0], (size_t)p->n, 4, false, GLB_ARRAY)));
	if (p->target[0]) {
		json_t *targets = json_array(), *names = json_array(), *weights = json_array();
		for (int k = 0; k < EXPORT_TARGETS; k++) {
			json_array_append_new(targets, json_pack("{s:i}", "POSITION", put_metres(g, (const float(*)[3])p->target[k], p->n, GLB_ARRAY)));
			json_array_append_new(names, json_string(export_pupil_names[k]));
			json_array_append_new(weights, json_real(0));
		}
		json_object_set_new(primitive, "targets", targets);
		json_object_set_new(out, "weights", weights);
		json_object_set_new(out, "extras", json_pack("{s:o,s:f}", "targetNames", names, "pupil_mm", pupil_mm));
	}
	return out;
}

static json_t *texture(int picture)
{
	return json_pack("{s:i}", "index", picture);
}

static json_t *extensions(json_t *material)
{
	json_t *e = json_object();
	json_object_set_new(material, "extensions", e);
	return e;
}

/* base: a picture, or -1 for black; rough: a picture, or -1 for 1. */
static json_t *material(int part, int base, int rough)
{
	json_t *pbr = json_pack("{s:f}", "metallicFactor", 0.0);
	if (base >= 0)
		json_object_set_new(pbr, "baseColorTexture", texture(base));
	else
		json_object_set_new(pbr, "baseColorFactor", json_pack("[f,f,f,f]", 0.0, 0.0, 0.0, 1.0));
	if (rough >= 0)
		json_object_set_new(pbr, "metallicRoughnessTexture", texture(rough));
	return json_pack("{s:s,s:o}", "name", export_part_names[part], "pbrMetallicRoughness", pbr);
}

static void no_mirror(json_t *material)
{
	json_object_set_new(extensions(material), "KHR_materials_specular", json_pack("{s:f}", "specularFactor", 0.0));
}

static json_t *materials(const struct export_eye *eye)
{
	json_t *iris = material(EXPORT_IRIS, EXPORT_PIC_IRIS, -1), *back = material(EXPORT_BACK, -1, -1);
	json_t *sclera = material(EXPORT_SCLERA, EXPORT_PIC_SCLERA, EXPORT_PIC_SCLERA_ROUGH);
	json_t *cornea = material(EXPORT_CORNEA, EXPORT_PIC_CORNEA, EXPORT_PIC_CORNEA_ROUGH), *e = extensions(cornea);
	no_mirror(iris);  // the aqueous wets it: no mirror between like and like
	no_mirror(back);
	json_object_set_new(iris, "normalTexture", json_pack("{s:i,s:f}", "index", EXPORT_PIC_IRIS_NORMAL, "scale", export_normal_scale));
	json_object_set_new(extensions(sclera), "KHR_materials_ior", json_pack("{s:f}", "ior", eye->index));
	json_object_set_new(e, "KHR_materials_ior", json_pack("{s:f}", "ior", eye->index));
	json_object_set_new(e, "KHR_materials_transmission",
	                    json_pack("{s:f,s:o}", "transmissionFactor", 1.0, "transmissionTexture", texture(EXPORT_PIC_CORNEA_VOLUME)));
	json_object_set_new(e, "KHR_materials_volume",
	                    json_pack("{s:f,s:o}", "thicknessFactor", metres * eye->depth_mm, "thicknessTexture", texture(EXPORT_PIC_CORNEA_VOLUME)));
	json_object_set_new(sclera, "extras", json_pack("{s:{s:f}}", "tear_film", "index", LOOK_FILM_INDEX));
	json_object_set_new(cornea, "extras", json_pack("{s:{s:f}}", "tear_film", "index", LOOK_FILM_INDEX));
	return json_pack("[o,o,o,o]", iris, back, sclera, cornea);
}

/* Images, textures (one each, of one sampler) and their bytes. */
static void put_pictures(json_t *root, struct glb_buffer *g, const struct export_png *png)
{
	json_t *images = json_array(), *textures = json_array();
	for (int i = 0; i < EXPORT_PICTURES; i++) {
		json_array_append_new(images, json_pack("{s:i,s:s}", "bufferView", glb_add_view(g, png[i].data, png[i].size, 0), "mimeType", "image/png"));
		json_array_append_new(textures, json_pack("{s:i,s:i}", "sampler", 0, "source", i));
	}
	json_object_set_new(root, "images", images);
	json_object_set_new(root, "textures", textures);
	enum { LINEAR = 9729, MIPMAPS = 9987, CLAMP = 33071 };
	json_object_set_new(root, "samplers", json_pack("[{s:i,s:i,s:i,s:i}]", "magFilter", LINEAR, "minFilter", MIPMAPS, "wrapS", CLAMP, "wrapT", CLAMP));
}

/* One node a mesh, below the root. */
static json_t *nodes(const char *name, const json_t *meshes)
{
	json_t *list = json_array(), *children = json_array(), *it;
	size_t i;
	json_array_append_new(list, json_pack("{s:s,s:o}", "name", name, "children", children));
	json_array_foreach(meshes, i, it) {
		json_array_append_new(children, json_integer(1 + (json_int_t)i));
		json_array_append_new(list, json_pack("{s:O,s:i}", "name", json_object_get(it, "name"), "mesh", (int)i));
	}
	return list;
}

/* Lashes and the meniscus, where there are any, with their materials. */
static void put_margin(struct glb_buffer *g, json_t *meshes, json_t *materials, const struct export_eye *eye)
{
	for (int k = 0; eye->margin && k < EXPORT_MARGIN_PARTS; k++) {
		if (!eye->margin[k].n_corners)
			continue;
		json_array_append_new(meshes, plain_mesh(g, &eye->margin[k], export_margin_names[k], (int)json_array_size(materials)));
		json_array_append_new(materials, k == EXPORT_TEARS ? tears_material() : strands_material(eye->hair_rgb));
	}
}

/* The file's JSON, its buffer in g; g's arrays pass on to it. */
static json_t *root_of(struct glb_buffer *g, const struct export_eye *eye)
{
	*g = (struct glb_buffer){ .views = json_array(), .accessors = json_array() };
	json_t *asset = json_pack("{s:s,s:s}", "version", "2.0", "generator", "Eyewright " EYEWRIGHT_VERSION), *meshes = json_array(), *looks = materials(eye);
	json_t *made = eye->made_by ? json_loads(eye->made_by, 0, 0) : 0;
	if (made)
		json_object_set_new(asset, "extras", json_pack("{s:o}", "made_by", made));
	for (int i = 0; i < EXPORT_PARTS; i++)
		json_array_append_new(meshes, mesh(g, &eye->parts[i], i, eye->pupil_mm));
	put_margin(g, meshes, looks, eye);
	json_t *root = json_pack("{s:o,s:[s,s,s,s],s:i,s:[{s:[i]}],s:o,s:o,s:o}", "asset", asset, "extensionsUsed", "KHR_materials_ior",
	                         "KHR_materials_specular", "KHR_materials_transmission", "KHR_materials_volume", "scene", 0, "scenes", "nodes", 0,
	                         "nodes", nodes(eye->name, meshes), "meshes", meshes, "materials", looks);
	put_pictures(root, g, eye->pictures);
	json_object_set_new(root, "accessors", g->accessors);
	json_object_set_new(root, "bufferViews", g->views);
	json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)g->size));
	return root;
}

bool export_eye_pack(char **out, size_t *size, const struct export_eye *eye, struct err *err)
{
	struct glb_buffer g;
	json_t *root = root_of(&g, eye);
	bool ok = glb_pack(out, size, &g, root, err);
	json_decref(root);
	free(g.bin);
	return ok;
}

bool export_eye_glb(const char *path, const struct export_eye *eye, long *bytes, struct err *err)
{
	struct glb_buffer g;
	json_t *root = root_of(&g, eye);
	bool ok = glb_save(path, &g, root, bytes, err);
	json_decref(root);
	free(g.bin);
	return ok;
}
