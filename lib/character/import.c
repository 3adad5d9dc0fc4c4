#include "character/import.h"

#include <stdlib.h>
#include <string.h>

#include "base/apart.h"
#include "base/file.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "character/build.h"
#include "character/plain/plain.h"
#include "character/convert.h"
#include "mesh/mesh_clean.h"
#include "mesh/mesh_joins.h"

enum { TEXTURE_MAX = 256 << 20 };
static const size_t FILE_MOST = (size_t)1 << 30;

bool character_has_look(const char *path)
{
	char *data;
	size_t size;
	struct err none = { 0 };
	if (character_kind_of(path) != CHARACTER_PLAIN)
		return character_kind_of(path) == CHARACTER_SCENE;
	if (!file_read(&data, &size, path, FILE_MOST, &none))
		return false;
	const bool found = character_names_look(path, data, size);
	free(data);
	return found;
}

/* What the process of its own is told. */
struct task {
	const char *folder, *name;
	long limit;
};

/* The vertices of an OBJ or PLY in the file's order. */
static bool given_vertices(struct mesh *out, const struct task *task, struct err *err)
{
	char *path = mem_printf("%s/%s", task->folder, task->name), *data = 0;
	size_t size;
	*out = (struct mesh){ 0 };
	const bool ok = character_kind_of(task->name) != CHARACTER_PLAIN
	                || (file_read(&data, &size, path, FILE_MOST, err) && mesh_clean(out, data, size, task->limit, err) && mesh_check(out, err));
	free(path);
	free(data);
	return ok;
}

static bool load_beside(void *ctx, char **data, size_t *size, const char *name, struct err *err)
{
	const struct task *task = ctx;
	char *path = 0;
	const bool ok = file_inside(&path, task->folder, name, err) && file_read(data, size, path, FILE_MOST, err);
	free(path);
	return ok;
}

/* A scene by Assimp; a packed glTF is unpacked first. */
static bool read_scene(struct ai_scene *scene, const struct task *task, struct err *err)
{
	struct ai_file file = { .folder = task->folder, .name = task->name };
	char *data = 0, *plain = 0, *name = 0;
	size_t size;
	if (character_is_gltf(task->name)) {
		if (!load_beside((void *)task, &data, &size, task->name, err) || !gltf_plain(&plain, &file.size, data, size, load_beside, (void *)task, err))
			return false;
		if (plain)
			file.name = name = mem_printf("%s.glb", task->name);
		else
			file.size = size;
		file.bytes = plain ? plain : data;
	}
	const bool ok = ai_scene_read(scene, &file, task->limit, TEXTURE_MAX, err);
	free(data);
	free(plain);
	free(name);
	return ok;
}

static bool read_apart(void *ctx, struct apart_out *out, struct err *err)
{
	const struct task *task = ctx;
	struct ai_scene scene;
	struct mesh mesh, given;
	struct look look;
	if (!given_vertices(&given, task, err) || !read_scene(&scene, task, err)
	    || !character_build(&mesh, &look, &scene, (const float(*)[3])given.vertices, given.n_vertices, err))
		return false;
	if (mesh.n_vertices > task->limit || mesh.n_faces > task->limit)
		return err_set(err, "%d vertices and %d faces, must be at most %ld", mesh.n_vertices, mesh.n_faces, task->limit);
	return look_put(&look, &mesh, out) || err_set(err, "has too much in it");
}

/* The wedge at a corner, of the file's face `from`, that belongs to that vertex of the sound mesh, and the rows after. */
static void follow_face(int32_t corner[3], const struct look *l, int from, const int32_t face[3], const int32_t *vertex_from)
{
	const int32_t *old = l->corner[from];
	int turn = 0;
	while (turn < 2 && l->point[old[turn]] != vertex_from[face[0]])
		turn++;
	for (int k = 0; k < 3; k++)
		corner[k] = old[(k + turn) % 3];
}

/* Makes the mesh a manifold, and lets the look follow: a wedge of a vertex that is doubled is doubled, too. */
static bool make_sound(struct mesh *mesh, struct look *l, struct err *err)
{
	int32_t *vertex_from = 0, *face_from = 0;
	if (mesh_joins_sound(mesh))
		return true;
	if (!om_mesh_sound(mesh, &vertex_from, &face_from, err))
		return false;
	struct look new = *l;
	const size_t n = (size_t)mesh->n_faces;
	new.n_faces = mesh->n_faces;
	new.corner = mem_new(n + 1, sizeof *new.corner);
	new.face_part = mem_new(n + 1, sizeof *new.face_part);
	new.face_material = mem_new(n + 1, sizeof *new.face_material);
	for (int f = 0; f < mesh->n_faces; f++) {
		follow_face(new.corner[f], l, face_from[f], mesh->faces[f], vertex_from);
		new.face_part[f] = l->face_part[face_from[f]];
		new.face_material[f] = l->face_material[face_from[f]];
	}
	free(l->corner);
	free(l->face_part);
	free(l->face_material);
	for (int f = 0; f < new.n_faces; f++)
		for (int k = 0; k < 3; k++) {
			const int32_t w = new.corner[f][k], v = mesh->faces[f][k];
			if (new.point[w] == v)
				continue;
			const size_t more = (size_t)++new.n_wedges;
			new.point = mem_grow(new.point, more, sizeof *new.point);
			new.uv = mem_grow(new.uv, more, sizeof *new.uv);
			new.normal = mem_grow(new.normal, more, sizeof *new.normal);
			new.rgba = mem_grow(new.rgba, more, sizeof *new.rgba);
			new.point[more - 1] = v;
			memcpy(new.uv[more - 1], new.uv[w], sizeof *new.uv);
			memcpy(new.normal[more - 1], new.normal[w], sizeof *new.normal);
			memcpy(new.rgba[more - 1], new.rgba[w], sizeof *new.rgba);
			new.corner[f][k] = (int32_t)more - 1;
		}
	// A doubled vertex moves with the one it was made from.
	int32_t *start = mem_new((size_t)new.n_shapes + 2, sizeof *start), *point = 0, moved = 0;
	float (*by)[3] = 0;
	size_t room = 0;
	int32_t *at = mem_new((size_t)l->n_points + 1, sizeof *at);
	for (int s = 0; s < new.n_shapes; s++) {
		for (int i = 0; i < l->n_points; i++)
			at[i] = -1;
		for (int k = l->shape_start[s]; k < l->shape_start[s + 1]; k++)
			at[l->shape_point[k]] = k;
		for (int v = 0; v < mesh->n_vertices; v++) {
			if (at[vertex_from[v]] < 0)
				continue;
			if ((size_t)moved == room) {
				room = 2 * room + 1024;
				point = mem_grow(point, room, sizeof *point);
				by = mem_grow(by, room, sizeof *by);
			}
			point[moved] = v;
			memcpy(by[moved++], l->shape_by[at[vertex_from[v]]], sizeof *by);
		}
		start[s + 1] = moved;
	}
	free(at);
	free(l->shape_start);
	free(l->shape_point);
	free(l->shape_by);
	new.shape_start = start;
	new.shape_point = point ? point : mem_new(1, sizeof *point);
	new.shape_by = by ? by : mem_new(1, sizeof *by);
	new.n_points = mesh->n_vertices;
	*l = new;
	free(vertex_from);
	free(face_from);
	return true;
}

bool character_import(struct mesh *mesh, struct look *look, const char *folder, const char *name, const struct character_limits *limits,
                      struct err *err)
{
	char *data = 0;
	size_t size;
	struct err why = { 0 };
	struct task task = { folder, name, limits->vertices };
	const struct apart apart = { .run = read_apart, .ctx = &task, .reads = folder, .memory = (size_t)(limits->mib * 1048576),
		                         .result = (size_t)(limits->mib * 1048576 / 2), .seconds = limits->seconds };
	*mesh = (struct mesh){ 0 };
	*look = (struct look){ 0 };
	char *path = mem_printf("%s/%s", folder, name);
	const bool opens = file_opens(path, FILE_MOST, err);
	free(path);
	if (!opens)
		return false;
	look_convert_ready();
	bool ok = apart_run(&data, &size, &apart, &why) && look_take(look, mesh, data, size, &why);
	free(data);
	ok = ok && mesh_check(mesh, &why) && make_sound(mesh, look, &why);
	if (ok)
		return true;
	mesh_free(mesh);
	look_free(look);
	return err_set(err, "%s/%s: %s", folder, name, why.msg);
}
