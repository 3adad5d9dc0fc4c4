#include "draw/face/impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

static const double reach_radii = 3.2;  // of an eyeball: what is subdivided
static const double fine_mm = 0.3;      // edges as short as this are not: a mesh as dense as a scan has its curves itself

static void *fresh(size_t n, size_t size)
{
	return mem_new(n + 1, size);
}

static bool near_eye(const struct rig *rig, int i)
{
	for (int s = 0; s < 2; s++) {
		double d[3];
		for (int c = 0; c < 3; c++)
			d[c] = rig->rest[i][c] - rig->globe[s].center[c];
		if (vec_norm(d) < reach_radii * rig->globe[s].radius)
			return true;
	}
	return false;
}

struct half_edge {
	int lo, hi, face, corner;
};

static int by_ends(const void *a, const void *b)
{
	const struct half_edge *p = a, *q = b;
	if (p->lo != q->lo)
		return p->lo < q->lo ? -1 : 1;
	if (p->hi != q->hi)
		return p->hi < q->hi ? -1 : 1;
	if (p->face != q->face)
		return p->face < q->face ? -1 : 1;
	return p->corner - q->corner;
}

/* New vertex on each edge of the marked faces; mid[face][corner]: the one opposite to a corner, or -1. */
static void cut_edges(struct portrait_mesh *m, const bool *marked, int (*mid)[3])
{
	int n = 0;
	struct half_edge *e = fresh(3 * (size_t)m->n_faces, sizeof *e);
	for (int f = 0; f < m->n_faces; f++)
		for (int k = 0; k < 3; k++) {
			int a = m->faces[f][(k + 1) % 3], b = m->faces[f][(k + 2) % 3];
			mid[f][k] = -1;
			e[n++] = (struct half_edge){ a < b ? a : b, a < b ? b : a, f, k };
		}
	qsort(e, (size_t)n, sizeof *e, by_ends);
	for (int i = 0, j; i < n; i = j) {
		bool cut = false;
		for (j = i; j < n && e[j].lo == e[i].lo && e[j].hi == e[i].hi; j++)
			cut = cut || marked[e[j].face];
		if (!cut)
			continue;
		for (int k = i; k < j; k++)
			mid[e[k].face][e[k].corner] = m->n;
		m->between = mem_grow(m->between, (size_t)(m->n - m->n_base) + 1, sizeof *m->between);
		m->between[m->n - m->n_base][0] = e[i].lo;
		m->between[m->n++ - m->n_base][1] = e[i].hi;
	}
	free(e);
}

/* Cuts a face whose marked edges have middles into triangles, without cracks between fine and coarse parts. */
static int cut_face(int32_t out[4][3], const int32_t v[3], const int mid[3])
{
	int n = (mid[0] >= 0) + (mid[1] >= 0) + (mid[2] >= 0), k = 0;
	int32_t all[4][3];
	if (n == 3) {
		memcpy(out, (int32_t[4][3]){ { v[0], mid[2], mid[1] }, { v[1], mid[0], mid[2] }, { v[2], mid[1], mid[0] }, { mid[0], mid[1], mid[2] } },
		       sizeof all);
		return 4;
	}
	while (n == 1 ? mid[k] < 0 : n == 2 && mid[k] >= 0)
		k++;
	int32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], p = mid[(k + 1) % 3], q = mid[(k + 2) % 3];
	if (n == 0)
		memcpy(out[0], v, sizeof *out);
	else if (n == 1)
		memcpy(out, (int32_t[2][3]){ { a, b, mid[k] }, { a, mid[k], c } }, 2 * sizeof *out);
	else
		memcpy(out, (int32_t[3][3]){ { a, q, p }, { q, b, c }, { q, c, p } }, 3 * sizeof *out);
	return n + 1;
}

/* Room for the texture coordinates of so many faces. */
static void undress(struct portrait_mesh *m, int n)
{
	m->uv = n ? fresh((size_t)n, sizeof *m->uv) : 0;
	m->material = n ? fresh((size_t)n, sizeof *m->material) : 0;
	m->cuts = n ? fresh((size_t)n, sizeof *m->cuts) : 0;
}

/* Texture coordinates of a face that was cut from another. */
static void follow(struct portrait_mesh *m, int face, const int32_t v[3], const struct portrait_mesh *was, int of, const int mid[3])
{
	for (int k = 0; k < 3; k++)
		for (int j = 0; j < 3; j++) {
			const float *a = was->uv[of][(j + 1) % 3], *b = was->uv[of][(j + 2) % 3];
			if (v[k] == was->faces[of][j])
				memcpy(m->uv[face][k], was->uv[of][j], sizeof m->uv[face][k]);
			else if (v[k] == mid[j])
				memcpy(m->uv[face][k], (float[2]){ 0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]) }, sizeof m->uv[face][k]);
		}
	m->material[face] = was->material[of];
	m->cuts[face] = was->cuts[of];
}

/* How much of the texture a millimetre of each face shows. */
static void measure(struct portrait_mesh *m)
{
	m->uv_per_mm = m->n_dressed ? fresh((size_t)m->n_dressed, sizeof *m->uv_per_mm) : 0;
	for (int f = 0; f < m->n_dressed; f++) {
		const int32_t *v = m->faces[f];
		const float (*t)[2] = (const float(*)[2])m->uv[f];
		double a[3], b[3], n[3];
		for (int c = 0; c < 3; c++) {
			a[c] = m->rest[v[1]][c] - m->rest[v[0]][c];
			b[c] = m->rest[v[2]][c] - m->rest[v[0]][c];
		}
		vec_cross(n, a, b);
		const double in_map = fabs((t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0]));
		m->uv_per_mm[f] = (float)sqrt(in_map / fmax(vec_norm(n), 1e-9));
	}
}

/* The look's texture coordinates and material of one of the rig's faces. */
static void dress_face(struct portrait_mesh *m, const struct dress *dress, int of)
{
	const struct look *l = dress_look(dress);
	for (int k = 0; k < 3; k++)
		memcpy(m->uv[m->n_faces][k], l->uv[l->corner[of][k]], sizeof m->uv[0][k]);
	m->material[m->n_faces] = (int16_t)(l->face_material[of] < INT16_MAX ? l->face_material[of] : -1);
	m->cuts[m->n_faces] = dress_cuts(dress, m->material[m->n_faces]);
	m->n_dressed++;
}

static void subdivide(struct portrait_mesh *m, bool *marked)
{
	int (*mid)[3] = fresh((size_t)m->n_faces, sizeof *mid), n = 0;
	int32_t (*faces)[3] = fresh(4 * (size_t)m->n_faces, sizeof *faces);
	bool *next = fresh(4 * (size_t)m->n_faces, sizeof *next);
	struct portrait_mesh was = *m;
	undress(m, 4 * was.n_dressed);
	cut_edges(m, marked, mid);
	for (int f = 0; f < m->n_faces; f++) {
		int32_t cut[4][3];
		int k = cut_face(cut, m->faces[f], mid[f]);
		memset(next + n, marked[f], (size_t)k);
		memcpy(faces + n, cut, (size_t)k * sizeof *faces);
		for (int i = 0; f < was.n_dressed && i < k; i++)
			follow(m, n + i, cut[i], &was, f, mid[f]);
		n += k;
		m->n_dressed = f < was.n_dressed ? n : m->n_dressed;
	}
	free(was.uv);
	free(was.material);
	free(was.cuts);
	free(m->faces);
	free(mid);
	m->faces = faces;
	m->n_faces = n;
	memcpy(marked, next, (size_t)n);
	free(next);
}

/* Middle of an edge on the curved surface of Phong tessellation. */
static void middle(float out[3], float normal[3], const float a[3], const float b[3], const float na[3], const float nb[3])
{
	float p[3], da = 0, db = 0, len = 0;
	for (int c = 0; c < 3; c++) {
		p[c] = 0.5f * (a[c] + b[c]);
		normal[c] = na[c] + nb[c];
		len += normal[c] * normal[c];
	}
	for (int c = 0; c < 3; c++) {
		da += (p[c] - a[c]) * na[c];
		db += (p[c] - b[c]) * nb[c];
	}
	len = len > 1e-12f ? 1 / sqrtf(len) : 1;
	for (int c = 0; c < 3; c++) {
		out[c] = p[c] - 0.5f * (da * na[c] + db * nb[c]);
		normal[c] *= len;
	}
}

static void between(float (*of)[3], const struct portrait_mesh *m)
{
	for (int i = m->n_base; i < m->n; i++)
		for (int c = 0; c < 3; c++)
			of[i][c] = 0.5f * (of[m->between[i - m->n_base][0]][c] + of[m->between[i - m->n_base][1]][c]);
}

/* Mean length of the rig's own edges of the marked faces, mm; infinite without any. */
static double edge_of(const struct portrait_mesh *m, const struct rig *rig, const bool *marked)
{
	double sum = 0;
	int n = 0;
	for (int f = 0; f < m->n_faces; f++)
		for (int k = 0; k < 3 && marked[f]; k++) {
			double d[3];
			for (int c = 0; c < 3; c++)
				d[c] = rig->rest[m->faces[f][k]][c] - rig->rest[m->faces[f][(k + 1) % 3]][c];
			sum += vec_norm(d);
			n++;
		}
	return n ? sum / n : INFINITY;
}

void portrait_mesh_make(struct portrait *p)
{
	const struct rig *rig = p->rig;
	struct portrait_mesh *m = &p->mesh;
	*m = (struct portrait_mesh){ .n = rig->n, .n_base = rig->n };
	m->faces = fresh((size_t)rig->n_faces, sizeof *m->faces);
	bool *marked = fresh((size_t)rig->n_faces << 2 * p->conf.subdivide, sizeof *marked);
	const struct dress *dress = p->conf.dress;
	int solid = 0, own = rig_own_faces(rig);
	undress(m, dress ? rig->n_faces : 0);
	// What shows through somewhere casts no shadow: it comes after what does. Last is the lining, which lies below the lids and wears nothing.
	for (int pass = 0; pass < (dress ? 2 : 1); pass++) {
		for (int f = 0; f < own; f++) {
			const int32_t *v = rig->faces[f];
			if (rig->part[v[0]] != RIG_SKIN || (dress && dress_cuts(dress, dress_look(dress)->face_material[f]) != (pass == 1)))
				continue;
			marked[m->n_faces] = near_eye(rig, v[0]) && near_eye(rig, v[1]) && near_eye(rig, v[2]);
			if (dress)
				dress_face(m, dress, f);
			memcpy(m->faces[m->n_faces++], v, sizeof *m->faces);
		}
		solid = pass ? solid : m->n_faces;
	}
	for (int f = own; f < rig->n_faces; f++) {
		marked[m->n_faces] = true;
		memcpy(m->faces[m->n_faces++], rig->faces[f], sizeof *m->faces);
	}
	p->shadow = ray_scene_new(rig->n, (const float(*)[3])rig->rest, solid, (const int32_t(*)[3])m->faces);
	p->solid = fresh((size_t)solid, sizeof *p->solid);
	memcpy(p->solid, m->faces, (size_t)solid * sizeof *p->solid);
	double edge = edge_of(m, rig, marked);
	for (int k = 0; k < p->conf.subdivide && edge > fine_mm; k++, edge /= 2)
		subdivide(m, marked);
	free(marked);
	size_t n = (size_t)m->n;
	m->x = fresh(n, sizeof *m->x);
	m->normal = fresh(n, sizeof *m->normal);
	m->rest = fresh(n, sizeof *m->rest);
	m->bare = fresh(n, sizeof *m->bare);
	m->light = fresh(n, sizeof *m->light);
	m->albedo = fresh(n, sizeof *m->albedo);
	m->open = fresh(n, sizeof *m->open);
	m->wet = fresh(n, sizeof *m->wet);
	memcpy(m->rest, rig->rest, (size_t)rig->n * sizeof *m->rest);
	between(m->rest, m);
	measure(m);
}

void portrait_mesh_move(struct portrait *p)
{
	struct portrait_mesh *m = &p->mesh;
	// Normals of the posed surface: algorithm 1's are those of skull and globe, and would not shade skin that bulges between them.
	struct mesh base = { p->rig->n, p->rig->n_faces, m->x, p->rig->faces, 0 };
	float (*normal)[3] = mesh_normals(&base);
	memcpy(m->normal, normal, (size_t)p->rig->n * sizeof *normal);
	free(normal);
	for (int i = m->n_base; i < m->n; i++) {
		const int *e = m->between[i - m->n_base];
		middle(m->x[i], m->normal[i], m->x[e[0]], m->x[e[1]], m->normal[e[0]], m->normal[e[1]]);
	}
	ray_scene_move(p->shadow, (const float(*)[3])m->x);
}

void portrait_mesh_free(struct portrait_mesh *m)
{
	free(m->between);
	free(m->faces);
	free(m->x);
	free(m->normal);
	free(m->rest);
	free(m->bare);
	free(m->light);
	free(m->albedo);
	free(m->open);
	free(m->wet);
	free(m->home);
	free(m->uv);
	free(m->material);
	free(m->cuts);
	free(m->uv_per_mm);
	*m = (struct portrait_mesh){ 0 };
}

void portrait_mesh_weights(float w[3], const struct portrait_mesh *m, int face, const float origin[3], const float dir[3])
{
	const int32_t *v = m->faces[face];
	const float *a = m->x[v[0]], *b = m->x[v[1]], *c = m->x[v[2]];
	float e[3], g[3], s[3], h[3], q[3];
	for (int k = 0; k < 3; k++) {
		e[k] = b[k] - a[k];
		g[k] = c[k] - a[k];
		s[k] = origin[k] - a[k];
	}
	h[0] = dir[1] * g[2] - dir[2] * g[1], h[1] = dir[2] * g[0] - dir[0] * g[2], h[2] = dir[0] * g[1] - dir[1] * g[0];
	q[0] = s[1] * e[2] - s[2] * e[1], q[1] = s[2] * e[0] - s[0] * e[2], q[2] = s[0] * e[1] - s[1] * e[0];
	float det = e[0] * h[0] + e[1] * h[1] + e[2] * h[2], k = fabsf(det) > 1e-12f ? 1 / det : 0;
	float w1 = (s[0] * h[0] + s[1] * h[1] + s[2] * h[2]) * k, w2 = (dir[0] * q[0] + dir[1] * q[1] + dir[2] * q[2]) * k;
	w1 = fminf(fmaxf(w1, 0), 1);  // samples at an edge may lie a hair outside
	w2 = fminf(fmaxf(w2, 0), 1 - w1);
	w[0] = 1 - w1 - w2;
	w[1] = w1;
	w[2] = w2;
}
