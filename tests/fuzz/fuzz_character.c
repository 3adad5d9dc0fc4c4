/* Characters as strangers have them. The first byte says what the rest is: a file for Assimp, in its process of its own (m: .glb, g: .gltf, f: .fbx, o: .obj);
 * what such a process hands over (r); a texture (t); else numbers of a scene as Assimp could give it, for what is made of one here. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "character/build.h"
#include "character/import.h"
#include "character/texture.h"

static void check(const struct mesh *mesh, const struct look *look)
{
	if (look->n_faces != mesh->n_faces || look->n_points != mesh->n_vertices)
		abort();
	for (int f = 0; f < look->n_faces; f++)
		for (int k = 0; k < 3; k++)
			if (look->corner[f][k] < 0 || look->corner[f][k] >= look->n_wedges || look->point[look->corner[f][k]] != mesh->faces[f][k])
				abort();
	for (int f = 0; f < look->n_faces; f++)
		if (look->face_part[f] < 0 || look->face_part[f] >= look->n_parts || look->face_material[f] >= look->n_materials)
			abort();
	for (int i = 0; i < look->shape_start[look->n_shapes]; i++)
		if (look->shape_point[i] < 0 || look->shape_point[i] >= look->n_points)
			abort();
}

static void said(bool ok, const struct err *err)
{
	if (ok == err_is(err) || strchr(err->msg, '\n'))
		abort();
}

static void file(const char *ending, const uint8_t *data, size_t size)
{
	static char *dir;
	const struct character_limits limits = { 20000, 2, 256 };
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	if (!dir)
		dir = mkdtemp(mem_printf("%s/character-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp"));
	char *name = mem_printf("x%s", ending), *path = mem_printf("%s/%s", dir, name);
	if (!file_write(path, data, size, &err))
		abort();
	const bool ok = character_import(&mesh, &look, dir, name, &limits, &err);
	said(ok, &err);
	if (ok)
		check(&mesh, &look);
	mesh_free(&mesh);
	look_free(&look);
	unlink(path);
	free(path);
	free(name);
}

/* Numbers, as long as there are any. */
struct source {
	const uint8_t *data;
	size_t size;
};

static unsigned take(struct source *s, unsigned below)
{
	if (!s->size)
		return 0;
	s->size--;
	return *s->data++ % below;
}

/* Few values, so that places are often the same; some that are no numbers. */
static float take_float(struct source *s)
{
	static const float some[] = { 0, 1, -1, 0.5f, -0.0f, 1e-7f, 1e30f, 2, 3, 4, 1e-30f };
	const unsigned k = take(s, 40);
	return k == 39 ? 0.0f / 0.0f : k == 38 ? 1.0f / 0.0f : k < sizeof some / sizeof *some ? some[k] : (float)k / 8;
}

static void fill(float *x, size_t n, struct source *s)
{
	for (size_t i = 0; i < n; i++)
		x[i] = take_float(s);
}

static struct ai_part part_of(struct source *s, int node)
{
	struct ai_part p = { .name = mem_str("part"), .n = 1 + (int)take(s, 24), .n_faces = (int)take(s, 24), .material = (int)take(s, 6) - 2, .n_shapes = (int)take(s, 3), .node = node };
	const size_t n = (size_t)p.n;
	p.x = mem_new(n, 12);
	fill(p.x[0], 3 * n, s);
	p.normal = take(s, 2) ? mem_new(n, 12) : 0;
	p.uv = take(s, 2) ? mem_new(n, 8) : 0;
	p.rgba = take(s, 2) ? mem_new(n, 16) : 0;
	if (p.normal)
		fill(p.normal[0], 3 * n, s);
	if (p.uv)
		fill(p.uv[0], 2 * n, s);
	if (p.rgba)
		fill(p.rgba[0], 4 * n, s);
	p.face = mem_new((size_t)p.n_faces + 1, 12);
	for (int f = 0; f < p.n_faces; f++)
		for (int k = 0; k < 3; k++)
			p.face[f][k] = (int32_t)take(s, (unsigned)p.n);  // the bridge checks these
	p.shape = mem_new((size_t)p.n_shapes + 1, sizeof *p.shape);
	for (int k = 0; k < p.n_shapes; k++) {
		p.shape[k].name = mem_printf("shape%u", take(s, 3));
		p.shape[k].by = mem_new(n, 12);
		fill(p.shape[k].by[0], 3 * n, s);
	}
	return p;
}

static void scene_free(struct ai_scene *scene)
{
	for (int i = 0; i < scene->n_parts; i++) {
		struct ai_part *p = &scene->part[i];
		for (int k = 0; k < p->n_shapes; k++) {
			free(p->shape[k].name);
			free(p->shape[k].by);
		}
		free(p->shape);
		free(p->name);
		free(p->x);
		free(p->normal);
		free(p->uv);
		free(p->rgba);
		free(p->face);
	}
	free(scene->part);
	for (int i = 0; i < scene->n_materials; i++)
		free(scene->material[i].name);
	free(scene->material);
}

static void scene(struct source *s)
{
	struct ai_scene scene = { .n_parts = 1 + (int)take(s, 4), .n_materials = (int)take(s, 4) };
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	scene.part = mem_new((size_t)scene.n_parts, sizeof *scene.part);
	scene.material = mem_new((size_t)scene.n_materials + 1, sizeof *scene.material);
	for (int i = 0, node = 0; i < scene.n_parts; i++, node += (int)take(s, 2))
		scene.part[i] = part_of(s, node);
	for (int i = 0; i < scene.n_materials; i++) {
		scene.material[i].name = mem_str("m");
		for (int k = 0; k < AI_MAPS; k++)
			scene.material[i].map[k] = -1;
	}
	const bool ok = character_build(&mesh, &look, &scene, 0, 0, &err);
	said(ok, &err);
	if (ok)
		check(&mesh, &look);
	mesh_free(&mesh);
	look_free(&look);
	scene_free(&scene);
}

static void texture(const uint8_t *data, size_t size)
{
	struct look_texture t = { .bytes = data, .size = (long)size };
	struct err err = { 0 };
	int width, height;
	const bool ok = look_texture_check(&t, &err);
	said(ok, &err);
	if (!ok || (long)t.width * t.height > 1 << 20)
		return;
	uint8_t *px = look_texture_pixels(&width, &height, &t, 64, &err);
	said(px != 0, &err);
	if (px && (width > 64 || height > 64 || width < 1 || height < 1))
		abort();
	free(px);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char kinds[] = "mgfo", *const endings[] = { ".glb", ".gltf", ".fbx", ".obj" };
	if (!size)
		return 0;
	const char *kind = memchr(kinds, data[0], sizeof kinds - 1);
	if (kind)
		file(endings[kind - kinds], data + 1, size - 1);
	else if (data[0] == 't')
		texture(data + 1, size - 1);
	else if (data[0] == 'r') {
		struct mesh mesh;
		struct look look;
		struct err err = { 0 };
		const bool ok = look_take(&look, &mesh, (const char *)data + 1, size - 1, &err);
		said(ok, &err);
		if (ok) {
			mesh_free(&mesh);
			look_free(&look);
		}
	} else
		scene(&(struct source){ data + 1, size - 1 });
	return 0;
}
