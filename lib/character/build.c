#include "character/build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "character/convert.h"
#include "character/texture.h"

/* A vertex of a part, to be sorted by place. */
struct placed {
	float x[3];
	int row;
};

static int by_place(const void *a, const void *b)
{
	const struct placed *p = a, *q = b;
	for (int c = 0; c < 3; c++)
		if (p->x[c] != q->x[c])
			return p->x[c] < q->x[c] ? -1 : 1;
	return p->row < q->row ? -1 : p->row > q->row;
}

static bool same_place(const struct placed *a, const struct placed *b)
{
	return a->x[0] == b->x[0] && a->x[1] == b->x[1] && a->x[2] == b->x[2];
}

/* Whether any blend shape moves a vertex. */
static bool moves(const struct ai_part *p, int a)
{
	bool any = false;
	for (int s = 0; s < p->n_shapes; s++)
		for (int c = 0; c < 3; c++)
			any = any || fabsf(p->shape[s].by[a][c]) > 1e-6f;
	return any;
}

/* Vertex a of one part and b of another, or of the same. */
static bool move_alike(const struct ai_part *p, int a, const struct ai_part *q, int b)
{
	if (p->n_shapes != q->n_shapes)
		return !moves(p, a) && !moves(q, b);
	for (int s = 0; s < p->n_shapes; s++)
		for (int c = 0; c < 3; c++)
			if (strcmp(p->shape[s].name, q->shape[s].name) || fabsf(p->shape[s].by[a][c] - q->shape[s].by[b][c]) > 1e-6f)
				return false;
	return true;
}

/* Parts of one node: primitives of one mesh. */
struct group {
	const struct ai_part *part;
	int n_parts, n;          // n: vertices of all
};

static struct group group_of(const struct ai_scene *s, int from)
{
	struct group g = { &s->part[from], 0, 0 };
	for (int i = from; i < s->n_parts && s->part[i].node == s->part[from].node; i++) {
		g.n_parts++;
		g.n += s->part[i].n;
	}
	return g;
}

/* The first vertex of the group that each vertex is one point with: [n]; rows run through the parts. A mesh of several materials is
 * one surface: its primitives join where they meet. */
static void weld(int32_t *first, const struct group *g)
{
	struct placed *at = mem_array((size_t)g->n + 1, sizeof *at);
	int *part = mem_array((size_t)g->n + 1, sizeof *part), *own = mem_array((size_t)g->n + 1, sizeof *own), n = 0;
	for (int k = 0; k < g->n_parts; k++)
		for (int i = 0; i < g->part[k].n; i++, n++) {
			at[n].row = n;
			part[n] = k;
			own[n] = i;
			for (int c = 0; c < 3; c++)
				at[n].x[c] = g->part[k].x[i][c] + 0.0f;  // no negative zero
		}
	qsort(at, (size_t)n, sizeof *at, by_place);
	for (int i = 0, j; i < n; i = j)
		for (j = i; j < n && same_place(&at[i], &at[j]); j++) {
			enum { TRIED = 16 };  // a file of a million vertices at one place costs no more than another
			const int row = at[j].row;
			first[row] = row;
			for (int k = i; k < j && k < i + TRIED; k++) {
				const int to = at[k].row;
				if (first[to] == to && move_alike(&g->part[part[to]], own[to], &g->part[part[row]], own[row])) {
					first[row] = to;
					break;
				}
			}
		}
	free(at);
	free(part);
	free(own);
}

/* Rows of the file's own vertices, by place. */
struct given {
	struct placed *at;
	int n;
	float reach;   // two readers of a decimal number may differ in its last bit
};

static struct given given_of(const float (*x)[3], int n)
{
	struct given g = { mem_array((size_t)n + 1, sizeof *g.at), n, 0 };
	for (int i = 0; i < n; i++) {
		memcpy(g.at[i].x, x[i], sizeof g.at[i].x);
		g.at[i].row = i;
		for (int c = 0; c < 3; c++)
			g.reach = fmaxf(g.reach, 4e-7f * fabsf(x[i][c]));
	}
	qsort(g.at, (size_t)n, sizeof *g.at, by_place);
	return g;
}

/* The row whose place is nearest; -1: none within reach. */
static int given_row(const struct given *g, const float x[3])
{
	int lo = 0, hi = g->n, best = -1;
	float least = 4 * g->reach * g->reach;
	while (lo < hi) {
		const int mid = (lo + hi) / 2;
		if (g->at[mid].x[0] < x[0] - g->reach)
			lo = mid + 1;
		else
			hi = mid;
	}
	for (; lo < g->n && g->at[lo].x[0] <= x[0] + g->reach; lo++) {
		float d = 0;
		for (int c = 0; c < 3; c++)
			d += (g->at[lo].x[c] - x[c]) * (g->at[lo].x[c] - x[c]);
		if (d < least || (best < 0 && d <= least)) {
			least = d;
			best = g->at[lo].row;
		}
	}
	return best;
}

/* What the scene has in all. */
static void count(struct look *l, struct mesh *mesh, const struct ai_scene *s)
{
	for (int i = 0; i < s->n_parts; i++) {
		l->n_wedges += s->part[i].n;
		l->n_faces += s->part[i].n_faces;
	}
	const size_t w = (size_t)l->n_wedges + 1, f = (size_t)l->n_faces + 1;
	l->point = mem_new(w, sizeof *l->point);
	l->uv = mem_new(w, sizeof *l->uv);
	l->normal = mem_new(w, sizeof *l->normal);
	l->rgba = mem_new(w, sizeof *l->rgba);
	l->corner = mem_new(f, sizeof *l->corner);
	l->face_part = mem_new(f, sizeof *l->face_part);
	l->face_material = mem_new(f, sizeof *l->face_material);
	l->part = mem_new((size_t)s->n_parts + 1, sizeof *l->part);
	mesh->faces = mem_new(f, sizeof *mesh->faces);
	mesh->vertices = mem_new(w, sizeof *mesh->vertices);
	l->n_faces = 0;
}

static void put_wedge(struct look *l, int w, const struct ai_part *p, int i)
{
	memcpy(l->normal[w], p->normal ? p->normal[i] : (float[3]){ 0 }, sizeof l->normal[w]);
	memcpy(l->uv[w], p->uv ? p->uv[i] : (float[2]){ 0 }, sizeof l->uv[w]);
	for (int c = 0; c < 4; c++)
		l->rgba[w][c] = p->rgba && isfinite(p->rgba[i][c]) ? fminf(fmaxf(p->rgba[i][c], 0), 1) : 1;
	for (int c = 0; c < 2; c++)
		if (!(fabsf(l->uv[w][c]) < 1e6f))
			l->uv[w][c] = 0;
	l->has_uv |= p->uv != 0;
}

static void put_faces(struct look *l, struct mesh *mesh, const struct ai_part *p, int part, int base, int n_materials)
{
	for (int f = 0; f < p->n_faces; f++) {
		int32_t v[3];
		for (int k = 0; k < 3; k++)
			v[k] = l->point[base + p->face[f][k]];
		if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
			continue;
		memcpy(mesh->faces[l->n_faces], v, sizeof v);
		for (int k = 0; k < 3; k++)
			l->corner[l->n_faces][k] = base + p->face[f][k];
		l->face_part[l->n_faces] = part;
		l->face_material[l->n_faces++] = p->material >= 0 && p->material < n_materials ? p->material : -1;
	}
}

/* One part of a group, whose vertices are those from `base` of the look's wedges; the group's are those from `group_base`. */
static void put_points(struct look *l, struct mesh *mesh, const struct ai_part *p, int base, int group_base, const int32_t *first, const struct given *given)
{
	for (int k = 0; k < p->n; k++) {
		const int row = given->n ? given_row(given, p->x[k]) : -1, w = base + k;
		if (row >= 0)
			l->point[w] = row;
		else if (first[w - group_base] != w - group_base)
			l->point[w] = l->point[group_base + first[w - group_base]];
		else {
			memcpy(mesh->vertices[mesh->n_vertices], p->x[k], sizeof *mesh->vertices);
			l->point[w] = mesh->n_vertices++;
		}
		put_wedge(l, w, p, k);
	}
}

/* Parts of one node leave as one mesh of several materials. */
static void put_parts(struct look *l, struct mesh *mesh, const struct ai_scene *s, const struct given *given)
{
	for (int i = 0, base = 0; i < s->n_parts;) {
		const struct group g = group_of(s, i);
		int32_t *first = mem_array((size_t)g.n + 1, sizeof *first);
		const int group_base = base;
		weld(first, &g);
		for (int k = 0; k < g.n_parts; base += g.part[k++].n) {
			put_points(l, mesh, &g.part[k], base, group_base, first, given);
			put_faces(l, mesh, &g.part[k], l->n_parts, base, s->n_materials);
		}
		l->part[l->n_parts++] = mem_str(g.part->name);
		free(first);
		i += g.n_parts;
	}
}

static int shape_row(struct look *l, const char *name)
{
	for (int i = 0; i < l->n_shapes; i++)
		if (!strcmp(l->shape[i], name))
			return i;
	l->shape = mem_grow(l->shape, (size_t)l->n_shapes + 1, sizeof *l->shape);
	l->shape[l->n_shapes] = mem_str(name);
	return l->n_shapes++;
}

/* Blend shapes of one name in several meshes are one. */
static void put_shapes(struct look *l, const struct ai_scene *s, int n_points)
{
	size_t room = 0;
	int n = 0;
	bool *done = mem_new((size_t)n_points + 1, 1);
	for (int i = 0; i < s->n_parts; i++)
		for (int k = 0; k < s->part[i].n_shapes; k++)
			shape_row(l, s->part[i].shape[k].name);
	l->shape_start = mem_new((size_t)l->n_shapes + 2, sizeof *l->shape_start);
	for (int shape = 0; shape < l->n_shapes; shape++) {
		memset(done, 0, (size_t)n_points);
		for (int i = 0, base = 0; i < s->n_parts; base += s->part[i++].n)
			for (int k = 0; k < s->part[i].n_shapes; k++) {
				const struct ai_shape *from = &s->part[i].shape[k];
				for (int v = 0; !strcmp(from->name, l->shape[shape]) && v < s->part[i].n; v++) {
					const float *by = from->by[v];
					const int32_t point = l->point[base + v];
					if (done[point] || !(by[0] || by[1] || by[2]))
						continue;
					if ((size_t)n == room) {
						room = 2 * room + 1024;
						l->shape_point = mem_grow(l->shape_point, room, sizeof *l->shape_point);
						l->shape_by = mem_grow(l->shape_by, room, sizeof *l->shape_by);
					}
					done[point] = true;
					l->shape_point[n] = point;
					memcpy(l->shape_by[n++], by, sizeof *l->shape_by);
				}
			}
		l->shape_start[shape + 1] = n;
	}
	free(done);
}

static void say_left_out(struct look *l, char *sentence)
{
	l->left_out = mem_grow(l->left_out, (size_t)l->n_left_out + 1, sizeof *l->left_out);
	l->left_out[l->n_left_out++] = sentence;
}

/* Textures that glTF can hold, and their rows: [n_textures of the scene]; -1: left out, and said so. */
static int *put_textures(struct look *l, const struct ai_scene *s)
{
	int *row = mem_new((size_t)s->n_textures + 1, sizeof *row);
	l->texture = mem_new((size_t)s->n_textures + 1, sizeof *l->texture);
	for (int i = 0; i < s->n_textures; i++) {
		const struct ai_texture *from = &s->texture[i];
		struct err why = { 0 };
		struct look_texture t = { .bytes = from->bytes, .size = (long)from->size };
		row[i] = -1;
		if (!from->bytes)
			err_set(&why, "%s", from->why);
		uint8_t *png = 0;
		size_t size;
		if (from->bytes && look_is_foreign(from->name, from->bytes, from->size) && (png = look_convert(&size, from->bytes, from->size, LOOK_TEXTURE_PX, &why)))
			t = (struct look_texture){ .bytes = png, .size = (long)size };
		if (err_is(&why) || !look_texture_check(&t, &why)) {
			say_left_out(l, mem_printf("texture %.80s: %.300s", from->name, why.msg));
			free(png);
			continue;
		}
		t.name = mem_str(from->name);
		l->bytes = mem_grow(l->bytes, (size_t)(l->n_bytes + t.size) + 1, 1);
		memcpy(l->bytes + l->n_bytes, t.bytes, (size_t)t.size);
		free(png);
		l->n_bytes += t.size;
		row[i] = l->n_textures;
		l->texture[l->n_textures++] = t;
	}
	return row;
}

static void put_materials(struct look *l, const struct ai_scene *s, const int *texture)
{
	l->material = mem_new((size_t)s->n_materials + 1, sizeof *l->material);
	for (int i = 0; i < s->n_materials; i++) {
		const struct ai_material *from = &s->material[i];
		struct look_material *to = &l->material[l->n_materials++];
		*to = (struct look_material){ .name = mem_str(from->name), .rgba = { from->rgba[0], from->rgba[1], from->rgba[2], from->rgba[3] },
			                          .rough = from->rough, .metal = from->metal, .cutoff = from->cutoff,
			                          .normal_scale = fmax(fmin(from->normal_scale, 100), -100),
			                          .glow = { from->emissive[0], from->emissive[1], from->emissive[2] },
			                          .alpha = (enum look_alpha)from->alpha, .two_sided = from->two_sided };
		for (int k = 0; k < LOOK_MAPS; k++)
			to->map[k] = from->map[k] >= 0 ? texture[from->map[k]] : -1;
	}
}

/* Normals of the surface for wedges that the file gives none. */
static void fill_normals(struct look *l, const struct mesh *mesh)
{
	float (*normal)[3] = mesh_normals(mesh);
	for (int w = 0; w < l->n_wedges; w++) {
		float *n = l->normal[w], len = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
		if (!(fabsf(len - 1) < 0.1f))
			memcpy(n, normal[l->point[w]], sizeof *normal);
	}
	free(normal);
}

bool character_build(struct mesh *mesh, struct look *look, const struct ai_scene *scene, const float (*given)[3], int n_given, struct err *err)
{
	*mesh = (struct mesh){ 0 };
	*look = (struct look){ 0 };
	// First of all: a place that is no number is not even the same as itself, and would be joined for ever.
	for (int i = 0; i < scene->n_parts; i++) {
		const struct mesh places = { .n_vertices = scene->part[i].n, .vertices = scene->part[i].x };
		if (!mesh_check(&places, err))
			return err_wrap(err, "%s", scene->part[i].name);
	}
	struct given rows = given_of(given, n_given);
	count(look, mesh, scene);
	if (n_given) {
		mesh->n_vertices = n_given;
		mesh->vertices = mem_grow(mesh->vertices, (size_t)n_given + (size_t)look->n_wedges + 1, sizeof *mesh->vertices);
		memcpy(mesh->vertices, given, (size_t)n_given * sizeof *given);
	}
	put_parts(look, mesh, scene, &rows);
	free(rows.at);
	mesh->n_faces = look->n_faces;
	look->n_points = mesh->n_vertices;
	if (!mesh->n_faces)
		return err_set(err, "has no faces");
	if (!mesh_check(mesh, err))
		return false;
	put_shapes(look, scene, mesh->n_vertices);
	int *texture = put_textures(look, scene);
	put_materials(look, scene, texture);
	free(texture);
	fill_normals(look, mesh);
	if (!look->bytes)
		look->bytes = mem_new(1, 1);
	if (!look->shape_point) {
		look->shape_point = mem_new(1, sizeof *look->shape_point);
		look->shape_by = mem_new(1, sizeof *look->shape_by);
	}
	return true;
}
