#include "character/look.h"

#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/apart.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "character/texture.h"

enum { ENTRIES = 14, NAME_MAX_BYTES = 200, TEXT_MAX = 1 << 22 };

static void free_names(char **names, int n)
{
	for (int i = 0; names && i < n; i++)
		free(names[i]);
	free(names);
}

void look_free(struct look *l)
{
	free(l->corner);
	free(l->face_part);
	free(l->face_material);
	free(l->point);
	free(l->uv);
	free(l->normal);
	free(l->rgba);
	free_names(l->part, l->n_parts);
	free_names(l->shape, l->n_shapes);
	free_names(l->left_out, l->n_left_out);
	for (int i = 0; l->material && i < l->n_materials; i++)
		free(l->material[i].name);
	for (int i = 0; l->texture && i < l->n_textures; i++)
		free(l->texture[i].name);
	free(l->material);
	free(l->texture);
	free(l->shape_start);
	free(l->shape_point);
	free(l->shape_by);
	free(l->bytes);
	*l = (struct look){ 0 };
}

static json_t *names_of(char *const *names, int n)
{
	json_t *list = json_array();
	for (int i = 0; i < n; i++) {
		json_t *name = json_string(names[i]);  // null where it is no UTF-8
		json_array_append_new(list, name ? name : json_string("unnamed"));
	}
	return list;
}

/* Materials, textures and names as JSON text; free(). */
static char *describe(const struct look *l)
{
	json_t *root = json_object(), *materials = json_array(), *textures = json_array();
	for (int i = 0; i < l->n_materials; i++) {
		const struct look_material *m = &l->material[i];
		json_t *o = json_object(), *maps = json_array(), *name = names_of(&m->name, 1);
		for (int k = 0; k < LOOK_MAPS; k++)
			json_array_append_new(maps, json_integer(m->map[k]));
		json_object_set(o, "name", json_array_get(name, 0));
		json_decref(name);
		json_object_set_new(o, "numbers", json_pack("[f,f,f,f,f,f,f,f,f,f,f]", m->rgba[0], m->rgba[1], m->rgba[2], m->rgba[3], m->rough,
		                                            m->metal, m->cutoff, m->normal_scale, m->glow[0], m->glow[1], m->glow[2]));
		json_object_set_new(o, "alpha", json_integer(m->alpha));
		json_object_set_new(o, "two_sided", json_boolean(m->two_sided));
		json_object_set_new(o, "maps", maps);
		json_array_append_new(materials, o);
	}
	for (int i = 0; i < l->n_textures; i++) {
		json_t *name = names_of(&l->texture[i].name, 1);
		json_array_append_new(textures, json_pack("{s:O, s:I}", "name", json_array_get(name, 0), "bytes", (json_int_t)l->texture[i].size));
		json_decref(name);
	}
	json_object_set_new(root, "materials", materials);
	json_object_set_new(root, "textures", textures);
	json_object_set_new(root, "parts", names_of(l->part, l->n_parts));
	json_object_set_new(root, "shapes", names_of(l->shape, l->n_shapes));
	json_object_set_new(root, "left_out", names_of(l->left_out, l->n_left_out));
	json_object_set_new(root, "uv", json_boolean(l->has_uv));
	char *text = json_dumps(root, JSON_COMPACT);
	json_decref(root);
	return text;
}

/* One array: its name, type, and shape, -1: any. */
struct entry {
	const char *name;
	enum npy_type type;
	long rows, width;  // width 0: of one dimension
	void **data;
};

/* The arrays of a look, and of the mesh's surface, where it is not null. text: describe(). */
static int entries(struct entry e[ENTRIES], struct look *l, struct mesh *mesh, char **text, long text_bytes)
{
	const long moved = l->shape_start ? l->shape_start[l->n_shapes] : -1;
	const struct entry all[] = {
		{ "description", NPY_U1, text_bytes, 0, (void **)text },
		{ "face_wedge", NPY_I4, l->n_faces, 3, (void **)&l->corner },
		{ "face_part", NPY_I4, l->n_faces, 0, (void **)&l->face_part },
		{ "face_material", NPY_I4, l->n_faces, 0, (void **)&l->face_material },
		{ "wedge_vertex", NPY_I4, l->n_wedges, 0, (void **)&l->point },
		{ "wedge_uv", NPY_F4, l->n_wedges, 2, (void **)&l->uv },
		{ "wedge_normal", NPY_F4, l->n_wedges, 3, (void **)&l->normal },
		{ "wedge_rgba", NPY_F4, l->n_wedges, 4, (void **)&l->rgba },
		{ "shape_start", NPY_I4, l->n_shapes + 1, 0, (void **)&l->shape_start },
		{ "shape_vertex", NPY_I4, moved, 0, (void **)&l->shape_point },
		{ "shape_by", NPY_F4, moved, 3, (void **)&l->shape_by },
		{ "texture_bytes", NPY_U1, l->n_bytes, 0, (void **)&l->bytes },
	};
	memcpy(e, all, sizeof all);
	if (!mesh)
		return COUNT(all);
	e[COUNT(all)] = (struct entry){ "vertices", NPY_F4, mesh->n_vertices, 3, (void **)&mesh->vertices };
	e[COUNT(all) + 1] = (struct entry){ "faces", NPY_I4, mesh->n_faces, 3, (void **)&mesh->faces };
	return COUNT(all) + 2;
}

static struct npy array_of(const struct entry *e)
{
	return npy_of(e->type, e->width ? 2 : 1, (long[]){ e->rows, e->width }, *e->data);
}

bool look_save(const struct look *look, const char *path, const char *made_by, struct err *err)
{
	struct look view = *look;
	struct entry e[ENTRIES];
	struct npz_item items[ENTRIES];
	char *text = describe(look);
	const int n = entries(e, &view, 0, &text, (long)strlen(text));
	for (int i = 0; i < n; i++)
		items[i] = (struct npz_item){ e[i].name, array_of(&e[i]) };
	const bool ok = npz_save(path, n, items, made_by, err);
	free(text);
	return ok;
}

bool look_put(const struct look *look, const struct mesh *mesh, struct apart_out *out)
{
	struct look view = *look;
	struct mesh surface = *mesh;
	struct entry e[ENTRIES];
	char *text = describe(look);
	bool ok = true;
	const int n = entries(e, &view, &surface, &text, (long)strlen(text));
	for (int i = 0; ok && i < n; i++) {
		const int64_t rows = e[i].rows;
		const size_t each = npy_type_size(e[i].type) * (size_t)(e[i].width ? e[i].width : 1);
		ok = apart_put(out, &rows, sizeof rows) && apart_put(out, *e[i].data, (size_t)rows * each);
	}
	free(text);
	return ok;
}

/* Takes the counts that follow from the arrays read so far. Array sizes were checked against INT_MAX. */
static void count(struct look *l, struct mesh *mesh, int at, long rows)
{
	switch (at) {
	case 1: l->n_faces = (int)rows; break;
	case 4: l->n_wedges = (int)rows; break;
	case 11: l->n_bytes = rows; break;
	case 12: mesh->n_vertices = (int)rows; break;
	case 13: mesh->n_faces = (int)rows; break;
	default: break;
	}
}

static bool take_names(char ***names, int *n, const json_t *root, const char *key, struct err *err)
{
	const json_t *list = json_object_get(root, key);
	if (!json_is_array(list) || json_array_size(list) > 100000)
		return err_set(err, "description: %s: must be a list", key);
	*names = mem_new(json_array_size(list) + 1, sizeof **names);
	for (size_t i = 0; i < json_array_size(list); i++) {
		const char *text = json_string_value(json_array_get(list, i));
		(*names)[(*n)++] = mem_printf("%.*s", NAME_MAX_BYTES, text ? text : "");
	}
	return true;
}

static bool take_material(struct look_material *m, const json_t *o, int n_textures, struct err *err)
{
	const json_t *numbers = json_object_get(o, "numbers"), *maps = json_object_get(o, "maps");
	const char *name = json_string_value(json_object_get(o, "name"));
	double x[11];
	if (json_array_size(numbers) != COUNT(x) || json_array_size(maps) != LOOK_MAPS)
		return err_set(err, "description: a material is damaged");
	for (int k = 0; k < COUNT(x); k++) {
		x[k] = json_number_value(json_array_get(numbers, (size_t)k));
		if (!(x[k] >= -1000 && x[k] <= 1000))
			return err_set(err, "description: a material's number is out of range");
	}
	*m = (struct look_material){ .rgba = { x[0], x[1], x[2], x[3] }, .rough = x[4], .metal = x[5], .cutoff = x[6], .normal_scale = x[7],
		                         .glow = { x[8], x[9], x[10] }, .two_sided = json_is_true(json_object_get(o, "two_sided")) };
	const json_int_t alpha = json_integer_value(json_object_get(o, "alpha"));
	m->alpha = alpha == LOOK_MASK ? LOOK_MASK : alpha == LOOK_BLEND ? LOOK_BLEND : LOOK_OPAQUE;
	for (int k = 0; k < LOOK_MAPS; k++) {
		const json_int_t t = json_integer_value(json_array_get(maps, (size_t)k));
		m->map[k] = t >= 0 && t < n_textures ? (int)t : -1;
	}
	m->name = mem_printf("%.*s", NAME_MAX_BYTES, name ? name : "");
	return true;
}

/* Sizes and kinds of the textures, from their own heads. */
static bool take_textures(struct look *l, const json_t *list, struct err *err)
{
	long at = 0;
	l->texture = mem_new(json_array_size(list) + 1, sizeof *l->texture);
	for (size_t i = 0; i < json_array_size(list); i++) {
		const json_t *o = json_array_get(list, i);
		const char *name = json_string_value(json_object_get(o, "name"));
		const json_int_t size = json_integer_value(json_object_get(o, "bytes"));
		struct look_texture *t = &l->texture[l->n_textures];
		if (size < 0 || size > l->n_bytes - at)
			return err_set(err, "description: texture %zu has more bytes than there are", i);
		*t = (struct look_texture){ .bytes = l->bytes + at, .size = (long)size };
		if (!look_texture_check(t, err))
			return err_wrap(err, "texture %zu", i);
		t->name = mem_printf("%.*s", NAME_MAX_BYTES, name ? name : "");
		l->n_textures++;
		at += (long)size;
	}
	return at == l->n_bytes || err_set(err, "description: the textures have other bytes than it says");
}

static bool take_description(struct look *l, const char *text, long size, struct err *err)
{
	json_error_t why;
	json_t *root = json_loadb(text, (size_t)size, 0, &why);
	bool ok = json_is_object(root) || err_set(err, "description: is damaged");
	const json_t *materials = json_object_get(root, "materials");
	ok = ok && take_textures(l, json_object_get(root, "textures"), err);
	l->material = mem_new(json_array_size(materials) + 1, sizeof *l->material);
	for (size_t i = 0; ok && i < json_array_size(materials); i++, l->n_materials += ok)
		ok = take_material(&l->material[i], json_array_get(materials, i), l->n_textures, err);
	l->has_uv = json_is_true(json_object_get(root, "uv"));
	int shapes = 0;
	ok = ok && take_names(&l->part, &l->n_parts, root, "parts", err) && take_names(&l->left_out, &l->n_left_out, root, "left_out", err)
	     && take_names(&l->shape, &shapes, root, "shapes", err);
	const bool same = shapes == l->n_shapes;
	l->n_shapes = shapes;
	json_decref(root);
	return ok && (same || err_set(err, "description: it names %d shapes, the file has others", shapes));
}

static bool all_finite(const float *x, long n)
{
	for (long i = 0; i < n; i++)
		if (!(fabsf(x[i]) <= 1e9f))
			return false;
	return true;
}

/* Whether every index points somewhere and every number is one. */
static bool check(struct look *l, const struct mesh *mesh, struct err *err)
{
	int points = 0;
	for (int i = 0; i < l->n_wedges; i++) {
		if (l->point[i] < 0 || l->point[i] == INT32_MAX || (mesh && l->point[i] >= mesh->n_vertices))
			return err_set(err, "wedge_vertex: %d is no vertex", l->point[i]);
		points = l->point[i] >= points ? l->point[i] + 1 : points;
	}
	for (int f = 0; f < l->n_faces; f++) {
		for (int k = 0; k < 3; k++) {
			if (l->corner[f][k] < 0 || l->corner[f][k] >= l->n_wedges)
				return err_set(err, "face_wedge: %d is no wedge", l->corner[f][k]);
			if (mesh && mesh->faces[f][k] != l->point[l->corner[f][k]])
				return err_set(err, "face_wedge: face %d is not the surface's", f);
		}
		if (l->face_part[f] < 0 || l->face_part[f] >= l->n_parts || l->face_material[f] < -1 || l->face_material[f] >= l->n_materials)
			return err_set(err, "face %d is of no part or material", f);
	}
	l->n_points = mesh ? mesh->n_vertices : points;
	for (int s = 0; s < l->n_shapes; s++)
		for (int k = l->shape_start[s]; k < l->shape_start[s + 1]; k++)
			if (l->shape_point[k] < 0 || (mesh && l->shape_point[k] >= mesh->n_vertices))
				return err_set(err, "shape_vertex: %d is no vertex", l->shape_point[k]);
	if (!all_finite(&l->uv[0][0], 2L * l->n_wedges) || !all_finite(&l->normal[0][0], 3L * l->n_wedges) || !all_finite(&l->rgba[0][0], 4L * l->n_wedges)
	    || !all_finite(&l->shape_by[0][0], 3L * l->shape_start[l->n_shapes]))
		return err_set(err, "a number is not finite");
	return true;
}

/* Whether the starts of the shapes rise from 0; the number of shapes. */
static bool take_starts(struct look *l, long rows, struct err *err)
{
	if (rows < 1 || l->shape_start[0] != 0)
		return err_set(err, "shape_start: must begin with 0");
	for (long i = 1; i < rows; i++)
		if (l->shape_start[i] < l->shape_start[i - 1])
			return err_set(err, "shape_start: must not fall");
	l->n_shapes = (int)rows - 1;
	return true;
}

static void empty(struct look *l, struct mesh *mesh)
{
	*l = (struct look){ .n_faces = -1, .n_wedges = -1, .n_shapes = -2, .n_bytes = -1 };
	if (mesh)
		*mesh = (struct mesh){ .n_vertices = -1, .n_faces = -1 };
}

/* Ends reading: checks all, or leaves nothing. */
static bool end(struct look *l, struct mesh *mesh, bool ok, char *text, long text_size, struct err *err)
{
	ok = ok && take_description(l, text, text_size, err)
	     && (!mesh || mesh->n_faces == l->n_faces || err_set(err, "faces: other ones than the look's")) && check(l, mesh, err);
	free(text);
	if (!ok) {
		look_free(l);
		if (mesh)
			mesh_free(mesh);
	}
	return ok;
}

bool look_take(struct look *l, struct mesh *mesh, const char *data, size_t size, struct err *err)
{
	char *text = 0;
	long text_size = -1;
	size_t at = 0;
	bool ok = true;
	empty(l, mesh);
	for (int i = 0, n = ENTRIES; ok && i < n; i++) {
		struct entry e[ENTRIES];
		int64_t rows;
		entries(e, l, mesh, &text, text_size);  // again, with the counts that are known by now
		const size_t each = npy_type_size(e[i].type) * (size_t)(e[i].width ? e[i].width : 1);
		if (size - at < sizeof rows)
			ok = err_set(err, "its reader stopped early");
		if (ok)
			memcpy(&rows, data + at, sizeof rows);
		at += sizeof rows;
		if (ok && (rows < 0 || rows > INT_MAX - 1 || (size_t)rows > (size - at) / each || (e[i].rows >= 0 && rows != e[i].rows)))
			ok = err_set(err, "%s: its reader gave another number of them", e[i].name);
		if (!ok)
			break;
		*e[i].data = mem_array((size_t)rows * each + 1, 1);
		memcpy(*e[i].data, data + at, (size_t)rows * each);
		at += (size_t)rows * each;
		count(l, mesh, i, rows);
		text_size = i == 0 ? (long)rows : text_size;
		ok = i != 8 || take_starts(l, (long)rows, err);
	}
	return end(l, mesh, ok, text, text_size, err);
}

bool look_load(struct look *l, const char *path, struct err *err)
{
	char *text = 0;
	long text_size = -1;
	bool ok = true;
	empty(l, 0);
	for (int i = 0, n = ENTRIES; ok && i < n; i++) {
		struct entry e[ENTRIES];
		struct npy a;
		n = entries(e, l, 0, &text, text_size);
		if (!npz_read(&a, path, e[i].name, NPY_LIMIT, err)) {
			ok = false;
			break;
		}
		ok = a.type == e[i].type || err_set(err, "%s: %s: another type of number than transfer writes: run it again", path, e[i].name);
		ok = ok && npy_expect(&a, path, e[i].width ? 2 : 1, (long[]){ e[i].rows, e[i].width }, err);
		if (ok) {
			*e[i].data = a.data;
			count(l, 0, i, a.shape[0]);
			text_size = i == 0 ? a.shape[0] : text_size;
			ok = i != 8 || take_starts(l, a.shape[0], err);
		} else
			npy_free(&a);
	}
	return end(l, 0, ok, text, text_size, err) || err_wrap(err, "%s", path);
}
