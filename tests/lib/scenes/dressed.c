#include "tests/lib/scenes/dressed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/picture.h"
#include "rig/glb/buffer.h"

enum { HEAD, EYES, RIGHT_EYE, HAIR, LID_HAIR, PARTS, CARDS = 24, LID_CARDS = 16 };
static const int material_of[PARTS] = { 0, 1, 1, 2, 2 };

struct box { float lo[3], hi[3]; };

static struct box box_of(const struct mesh *m)
{
	struct box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
	for (int i = 0; i < m->n_vertices; i++)
		for (int c = 0; c < 3; c++) {
			b.lo[c] = fminf(b.lo[c], m->vertices[i][c]);
			b.hi[c] = fmaxf(b.hi[c], m->vertices[i][c]);
		}
	return b;
}

static void turned(float out[3], const float in[3], const struct dressed *how)
{
	const float x[3] = { in[0], how->z_up ? -in[2] : in[1], how->z_up ? in[1] : in[2] };
	memcpy(out, x, sizeof x);
}

void dressed_place(float out[3], const float in[3], const struct dressed *how)
{
	turned(out, in, how);
	for (int c = 0; c < 3; c++)
		out[c] *= (float)how->unit;
}

/* The mesh of the file that a vertex is of: the largest piece is the head. */
static uint8_t *pieces(const struct mesh *m, bool apart)
{
	int *up = mem_new((size_t)m->n_vertices + 1, sizeof *up), *size = mem_new((size_t)m->n_vertices + 1, sizeof *size), best = 0;
	uint8_t *part = mem_new((size_t)m->n_vertices + 1, 1);
	for (int i = 0; i < m->n_vertices; i++)
		up[i] = i;
	for (bool more = true; more;) {
		more = false;
		for (int f = 0; f < m->n_faces; f++) {
			const int32_t *v = m->faces[f];
			const int a = up[v[0]], b = up[v[1]], c = up[v[2]], least = a < b ? a < c ? a : c : b < c ? b : c;
			more = more || a != least || b != least || c != least;
			up[v[0]] = up[v[1]] = up[v[2]] = least;
		}
	}
	for (int i = 0; i < m->n_vertices; i++)
		best = ++size[up[i]] > size[best] ? up[i] : best;
	for (int i = 0; i < m->n_vertices; i++)
		part[i] = up[i] == best ? HEAD : apart && m->vertices[i][0] < 0 ? RIGHT_EYE : EYES;
	free(up);
	free(size);
	return part;
}

/* A mesh of the file: rows with texture coordinates, row -1: a hair card's own. */
struct part {
	int n, n_faces;
	float (*x)[3], (*normal)[3], (*uv)[2];
	int *vertex;
	uint32_t (*face)[3];
};

static void add_row(struct part *p, const float x[3], const float n[3], float u, float v, int vertex)
{
	memcpy(p->x[p->n], x, sizeof *p->x);
	memcpy(p->normal[p->n], n, sizeof *p->normal);
	p->uv[p->n][0] = u;
	p->uv[p->n][1] = v;
	p->vertex[p->n++] = vertex;
}

static struct part part_new(int rows, int faces)
{
	return (struct part){ .x = mem_new((size_t)rows, 12), .normal = mem_new((size_t)rows, 12), .uv = mem_new((size_t)rows, 8),
		                  .vertex = mem_new((size_t)rows, sizeof(int)), .face = mem_new((size_t)faces, 12) };
}

/* Cylindrical coordinates; those of a face beyond the seam at the back of the head stand again, a turn further. */
static void put_surface(struct part *p, const struct mesh *m, const struct box *b, const uint8_t *piece, int which, const float (*normal)[3])
{
	int *row = mem_new(2 * (size_t)m->n_vertices + 2, sizeof *row);
	*p = part_new(2 * m->n_vertices + 1, m->n_faces + 1);
	for (int f = 0; f < m->n_faces; f++) {
		const int32_t *v = m->faces[f];
		float u[3];
		if (piece[v[0]] != which)
			continue;
		for (int k = 0; k < 3; k++)
			u[k] = 0.5f + atan2f(m->vertices[v[k]][0], m->vertices[v[k]][2] - 0.5f * (b->lo[2] + b->hi[2])) / (float)(2 * M_PI);
		const bool seam = fmaxf(fmaxf(u[0], u[1]), u[2]) - fminf(fminf(u[0], u[1]), u[2]) > 0.5f;
		for (int k = 0; k < 3; k++) {
			const bool far = seam && u[k] < 0.5f;
			int *r = &row[2 * v[k] + far];
			if (!*r) {
				const float *x = m->vertices[v[k]];
				add_row(p, x, normal[v[k]], u[k] + (float)far, (b->hi[1] - x[1]) / (b->hi[1] - b->lo[1]), v[k]);
				*r = p->n;
			}
			p->face[p->n_faces][k] = (uint32_t)(*r - 1);
		}
		p->n_faces++;
	}
	free(row);
}

/* Cards that stand on the crown. */
static void put_cards(struct part *p, const struct box *b)
{
	*p = part_new(4 * CARDS, 2 * CARDS);
	const float size = 0.06f * (b->hi[1] - b->lo[1]);
	for (int i = 0; i < CARDS; i++) {
		const float a = (float)(2 * M_PI * i / CARDS), r = 0.3f * (b->hi[0] - b->lo[0]), n[3] = { sinf(a), 0, cosf(a) };
		const float mid[3] = { r * sinf(a), b->hi[1] - 1.2f * size, 0.5f * (b->lo[2] + b->hi[2]) + r * cosf(a) };
		for (int k = 0; k < 4; k++) {
			const float s = k == 1 || k == 2 ? 0.5f : -0.5f, t = k > 1;
			const float x[3] = { mid[0] + s * size * cosf(a), mid[1] + 2 * t * size, mid[2] - s * size * sinf(a) };
			add_row(p, x, n, s + 0.5f, 1 - t, -1);
		}
		const uint32_t v = (uint32_t)(4 * i);
		memcpy(p->face[p->n_faces++], (uint32_t[3]){ v, v + 1, v + 2 }, 12);
		memcpy(p->face[p->n_faces++], (uint32_t[3]){ v, v + 2, v + 3 }, 12);
	}
}

/* Cards that stand on skin before and above the left eyeball, from the lid's edge to the brow: a vertex of the head each, their own beside it. */
static void put_lid_cards(struct part *p, const struct mesh *m, const uint8_t *piece, const float (*normal)[3])
{
	float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, mid[3];
	int *near = mem_new((size_t)m->n_vertices + 1, sizeof *near), n = 0;
	*p = part_new(4 * LID_CARDS, 2 * LID_CARDS);
	for (int i = 0; i < m->n_vertices; i++)
		for (int c = 0; c < 3 && piece[i] != HEAD && m->vertices[i][0] > 0; c++) {
			lo[c] = fminf(lo[c], m->vertices[i][c]);
			hi[c] = fmaxf(hi[c], m->vertices[i][c]);
		}
	const float R = 0.5f * (hi[1] - lo[1]);
	for (int c = 0; c < 3; c++)
		mid[c] = 0.5f * (lo[c] + hi[c]);
	for (int i = 0; i < m->n_vertices; i++) {
		const float *x = m->vertices[i], d[3] = { x[0] - mid[0], x[1] - mid[1], x[2] - mid[2] }, r = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		const float out = (d[0] * normal[i][0] + d[1] * normal[i][1] + d[2] * normal[i][2]) / r;
		if (piece[i] == HEAD && r < 1.6f * R && d[2] > 0.4f * R && d[1] > 0.15f * R && fabsf(d[0]) < 0.7f * R && out > 0.5f)
			near[n++] = i;
	}
	for (int k = 0; k < LID_CARDS && k < n; k++) {
		const int i = near[k * n / (n < LID_CARDS ? n : LID_CARDS)];
		const float *x = m->vertices[i], *a = normal[i];
		for (int v = 0; v < 4; v++) {
			const float side = (v == 1 || v == 2 ? 0.02f : -0.02f) * R, up = (v > 1 ? 0.25f : 0.01f) * R;
			add_row(p, (float[3]){ x[0] + side + up * a[0], x[1] + up * a[1], x[2] + up * a[2] }, (float[3]){ 0, 0, 1 }, side > 0, v < 2, -1);
		}
		const uint32_t v = (uint32_t)(4 * k);
		memcpy(p->face[p->n_faces++], (uint32_t[3]){ v, v + 1, v + 2 }, 12);
		memcpy(p->face[p->n_faces++], (uint32_t[3]){ v, v + 2, v + 3 }, 12);
	}
	free(near);
}

/* Colour with brows and lips; normals of a fine weave; roughness and metalness. kind: 0 colour, 1 normal, 2 roughness, 3 hair. */
static int add_texture(struct glb_buffer *g, json_t *images, json_t *textures, int kind, int px, const struct dressed *how)
{
	uint32_t seed = (uint32_t)kind + 1;
	uint8_t *rgba = mem_new(4 * (size_t)px * (size_t)px, 1), *data;
	size_t size;
	struct err none = { 0 };
	for (int y = 0; y < px; y++)
		for (int x = 0; x < px; x++) {
			const double u = (x + 0.5) / px, v = (y + 0.5) / px, brow = fabs(fabs(u - 0.5) - 0.055) < 0.03 && fabs(v - 0.41) < 0.008;
			const double lips = fabs(u - 0.5) < 0.035 && fabs(v - 0.77) < 0.012, hair = 0.5 + 0.5 * sin(60 * u);
			const double colour[3] = { brow ? 0.2 : lips ? 0.7 : 0.86, brow ? 0.13 : lips ? 0.3 : 0.67, brow ? 0.1 : lips ? 0.3 : 0.56 };
			const double own[3] = { how->halves ? 0.8 * (u > 0.5) : colour[0], how->halves ? 0.05 : colour[1], how->halves ? 0.8 * (u < 0.5) : colour[2] };
			const double normal[3] = { 0.5 + 0.06 * sin(400 * u), 0.5 + 0.06 * sin(400 * v), 1 };
			uint8_t *p = rgba + 4 * ((size_t)y * (size_t)px + (size_t)x);
			for (int c = 0; c < 3; c++)
				p[c] = (uint8_t)(255 * (kind == 0 ? own[c] : kind == 1 ? normal[c] : kind == 2 ? (double[]){ 1, 0.6, 0 }[c] : 0.15));
			for (int c = 0; c < 3 && how->grain && kind != 3; c++) {
				const int noise = p[c] + (int)((seed = seed * 1664525 + 1013904223) >> 28) - 8;
				p[c] = (uint8_t)(noise < 0 ? 0 : noise > 255 ? 255 : noise);
			}
			p[3] = kind == 3 && hair < 0.5 ? 0 : 255;
		}
	picture_png_encode(&data, &size, rgba, px, px, 4, &none);
	const int view = glb_add_view(g, data, size, 0);
	json_array_append_new(images, json_pack("{s:i,s:s}", "bufferView", view, "mimeType", "image/png"));
	json_array_append_new(textures, json_pack("{s:i}", "source", (int)json_array_size(images) - 1));
	free(rgba);
	free(data);
	return (int)json_array_size(textures) - 1;
}

static const char *const shape_names[] = { "jawOpen", "eyeBlink_L", "sneer" };

/* A blend shape of the head: [n], the mesh's unit. */
static void shape(float (*by)[3], const struct part *p, const struct box *b, int which)
{
	const float size = b->hi[1] - b->lo[1];
	for (int i = 0; i < p->n; i++) {
		const float v = p->uv[i][1], u = p->uv[i][0];
		const float w = which == 0 ? fmaxf(0, fminf((v - 0.7f) * 8, 1)) : which == 1 ? (u > 0.5f && u < 0.65f && v > 0.4f && v < 0.5f) : fmaxf(0, 1 - 30 * fabsf(v - 0.6f));
		memset(by[i], 0, sizeof by[i]);
		by[i][which == 0 ? 1 : 2] = (which == 0 ? -0.04f : 0.01f) * size * w;
	}
}

static json_t *mesh_json(struct glb_buffer *g, const struct part *p, const struct box *b, int which, const struct dressed *how)
{
	float (*x)[3] = mem_new((size_t)p->n + 1, sizeof *x), (*n)[3] = mem_new((size_t)p->n + 1, sizeof *n);
	for (int i = 0; i < p->n; i++) {
		turned(x[i], p->x[i], how);
		turned(n[i], p->normal[i], how);
	}
	json_t *attributes = json_object();
	json_object_set_new(attributes, "POSITION", json_integer(glb_add_floats(g, &x[0][0], (size_t)p->n, 3, true, GLB_ARRAY)));
	json_object_set_new(attributes, "NORMAL", json_integer(glb_add_floats(g, &n[0][0], (size_t)p->n, 3, false, GLB_ARRAY)));
	if (!how->no_uv)
		json_object_set_new(attributes, "TEXCOORD_0", json_integer(glb_add_floats(g, &p->uv[0][0], (size_t)p->n, 2, false, GLB_ARRAY)));
	if (how->skinned) {
		float (*one)[4] = mem_new((size_t)p->n, sizeof *one);
		uint8_t *joint = mem_new(4 * (size_t)p->n, 1);
		for (int i = 0; i < p->n; i++)
			one[i][0] = 1;
		json_object_set_new(attributes, "WEIGHTS_0", json_integer(glb_add_floats(g, &one[0][0], (size_t)p->n, 4, false, GLB_ARRAY)));
		const int view = glb_add_view(g, joint, 4 * (size_t)p->n, GLB_ARRAY);
		json_object_set_new(attributes, "JOINTS_0", json_integer(glb_add_accessor(g, json_pack("{s:i,s:i,s:i,s:s}", "bufferView", view, "componentType",
		                                                                                       5121, "count", p->n, "type", "VEC4"))));
		free(one);
		free(joint);
	}
	const int pieces = which == HEAD && how->used_materials ? how->used_materials : 1, first = 3 + how->many_materials;
	json_t *targets = which == HEAD ? json_array() : 0, *mesh = json_pack("{s:[]}", "primitives");
	for (int k = 0; k < pieces; k++) {
		const int from = (int)((long)p->n_faces * k / pieces), to = (int)((long)p->n_faces * (k + 1) / pieces);
		const int view = glb_add_view(g, p->face + from, 12 * (size_t)(to - from), GLB_INDICES);
		const int index = glb_add_accessor(g, json_pack("{s:i,s:i,s:i,s:s}", "bufferView", view, "componentType", GLB_UINT, "count", 3 * (to - from),
		                                                "type", "SCALAR"));
		json_t *primitive = json_pack("{s:O,s:i}", "attributes", attributes, "indices", index);
		if (!how->no_material)
			json_object_set_new(primitive, "material", json_integer(pieces > 1 ? first + k : material_of[which]));
		if (targets)
			json_object_set(primitive, "targets", targets);
		json_array_append_new(json_object_get(mesh, "primitives"), primitive);
	}
	json_decref(attributes);
	if (targets) {
		json_t *names = json_array();
		for (int s = 0; s < COUNT(shape_names); s++) {
			shape(x, p, b, s);
			for (int i = 0; i < p->n; i++)
				turned(n[i], x[i], how);
			json_array_append_new(targets, json_pack("{s:i}", "POSITION", glb_add_floats(g, &n[0][0], (size_t)p->n, 3, true, GLB_ARRAY)));
			json_array_append_new(names, json_string(shape_names[s]));
		}
		json_object_set_new(mesh, "extras", json_pack("{s:o}", "targetNames", names));
		json_object_set_new(mesh, "weights", json_pack("[i,i,i]", 0, 0, 0));
	}
	json_decref(targets);
	free(x);
	free(n);
	return mesh;
}

static json_t *materials(struct glb_buffer *g, json_t *root, const struct dressed *how)
{
	json_t *images = json_array(), *textures = json_array(), *list = json_array();
	int map[4];
	for (int k = 0; k < 4; k++)
		map[k] = add_texture(g, images, textures, k, k == 0 || (how->grain && k < 3) ? how->texture_px : how->texture_px / 4, how);
	json_array_append_new(list, json_pack("{s:s,s:{s:{s:i},s:{s:i},s:f},s:{s:i}}", "name", "Skin", "pbrMetallicRoughness", "baseColorTexture", "index",
	                                      map[0], "metallicRoughnessTexture", "index", map[2], "metallicFactor", 0.0, "normalTexture", "index", map[1]));
	json_array_append_new(list, json_pack("{s:s,s:{s:[f,f,f,f]}}", "name", "Eyeballs", "pbrMetallicRoughness", "baseColorFactor", 0.1, 0.9, 0.1, 1.0));
	json_array_append_new(list, json_pack("{s:s,s:s,s:b,s:{s:{s:i}}}", "name", "Hair", "alphaMode", "MASK", "doubleSided", 1, "pbrMetallicRoughness",
	                                      "baseColorTexture", "index", map[3]));
	for (int i = 0; i < how->many_materials; i++)
		json_array_append_new(list, json_pack("{s:s}", "name", "more"));
	for (int i = 0; i < how->used_materials; i++)
		json_array_append_new(list, json_pack("{s:o,s:{s:{s:i},s:f}}", "name", json_sprintf("Skin%d", i), "pbrMetallicRoughness", "baseColorTexture", "index",
		                                      map[0], "metallicFactor", 0.0));
	json_object_set_new(root, "images", images);
	json_object_set_new(root, "textures", textures);
	return list;
}

bool dressed_write(const char *path, const struct mesh *mesh, const struct dressed *how, struct err *err)
{
	static const char *const names[2][PARTS] = { { "Head", "Eyes", "", "Hair", "LidHair" }, { "Head", "EyeLeft", "EyeRight", "Hair", "LidHair" } };
	struct glb_buffer g = { .views = json_array(), .accessors = json_array() };
	const struct box b = box_of(mesh);
	uint8_t *piece = pieces(mesh, how->eyes_apart);
	float (*normal)[3] = mesh_normals(mesh);
	struct part part[PARTS];
	put_surface(&part[HEAD], mesh, &b, piece, HEAD, (const float(*)[3])normal);
	put_surface(&part[EYES], mesh, &b, piece, EYES, (const float(*)[3])normal);
	put_surface(&part[RIGHT_EYE], mesh, &b, piece, RIGHT_EYE, (const float(*)[3])normal);
	put_cards(&part[HAIR], &b);
	part[LID_HAIR] = (struct part){ 0 };
	if (how->lid_hair)
		put_lid_cards(&part[LID_HAIR], mesh, piece, (const float(*)[3])normal);
	json_t *root = json_pack("{s:{s:s},s:i,s:[{s:[i]}]}", "asset", "version", "2.0", "scene", 0, "scenes", "nodes", 0), *meshes = json_array();
	json_t *nodes = json_array(), *children = json_array();
	json_array_append_new(nodes, json_pack("{s:s,s:[f,f,f],s:O}", "name", "Character", "scale", how->unit, how->unit, how->unit, "children", children));
	for (int i = 0; i < PARTS; i++) {
		if (!part[i].n_faces)
			continue;
		json_array_append_new(meshes, mesh_json(&g, &part[i], &b, i, how));
		json_t *node = json_pack("{s:s,s:i}", "name", names[how->eyes_apart][i], "mesh", (int)json_array_size(meshes) - 1);
		if (how->skinned)
			json_object_set_new(node, "skin", json_integer(0));
		json_array_append_new(children, json_integer((json_int_t)json_array_size(nodes)));
		json_array_append_new(nodes, node);
	}
	if (how->skinned) {  // the joint is turned by a quarter about x
		const float bind[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
		const int view = glb_add_view(&g, bind, sizeof bind, 0);
		const int matrices = glb_add_accessor(&g, json_pack("{s:i,s:i,s:i,s:s}", "bufferView", view, "componentType", GLB_FLOAT, "count", 1, "type", "MAT4"));
		const int joint = (int)json_array_size(nodes);
		json_array_append_new(children, json_integer(joint));
		json_array_append_new(nodes, json_pack("{s:s,s:[f,f,f,f]}", "name", "neck", "rotation", sqrt(0.5), 0.0, 0.0, sqrt(0.5)));
		json_object_set_new(root, "skins", json_pack("[{s:[i],s:i}]", "joints", joint, "inverseBindMatrices", matrices));
	}
	json_decref(children);
	if (!how->no_material)
		json_object_set_new(root, "materials", materials(&g, root, how));
	json_object_set_new(root, "nodes", nodes);
	json_object_set_new(root, "meshes", meshes);
	json_object_set_new(root, "accessors", g.accessors);
	json_object_set_new(root, "bufferViews", g.views);
	json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)g.size));
	long bytes;
	const bool ok = glb_save(path, &g, root, &bytes, err);
	json_decref(root);
	free(g.bin);
	for (int i = 0; i < PARTS; i++) {
		free(part[i].x);
		free(part[i].normal);
		free(part[i].uv);
		free(part[i].vertex);
		free(part[i].face);
	}
	free(piece);
	free((void *)normal);
	return ok;
}
