/* What a character's mesh has not where eye and lids meet: a lining of the lids where it ends at their edges, so that no slit is left beside
 * the eyeball, and in each inner corner a caruncle and the fold beside it, the plica semilunaris. They are vertices and faces of their own,
 * behind all others, which follow the lids (B+ says which vertices) and keep their distance from the globe at every gaze. */
#include "rig/make/lining_impl.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/deform/opening.h"

/* Of an eyeball of 12 mm, mm. */
static const double edge_mm = 4;            // a mesh's edge so near the eyeball is a lid's
static const double wide_mm[] = { 10, 2 };  // least width and height of what is an eye's opening

/* The edges of the skin's surface: next[v], the vertex after v as the face at the edge goes round; -1: inside, -2: several. free(). */
static int *edges_of(const struct rig *rig)
{
	int *next = mem_array((size_t)rig->n + 1, sizeof *next), *start = mem_new((size_t)rig->n + 2, sizeof *start), *to = mem_array(3 * (size_t)rig->n_faces + 1, sizeof *to);
	for (int i = 0; i < rig->n; i++)
		next[i] = -1;
	for (int f = 0; f < 3 * rig->n_faces; f++)
		start[rig->faces[f / 3][f % 3] + 2]++;
	for (int i = 2; i <= rig->n + 1; i++)
		start[i] += start[i - 1];
	for (int f = 0; f < 3 * rig->n_faces; f++)
		to[start[rig->faces[f / 3][f % 3] + 1]++] = rig->faces[f / 3][(f + 1) % 3];
	for (int a = 0; a < rig->n; a++)
		for (int k = start[a]; k < start[a + 1]; k++) {
			bool back = rig->part[a] != RIG_SKIN;
			for (int j = start[to[k]]; j < start[to[k] + 1]; j++)
				back = back || to[j] == a;
			if (!back)
				next[a] = next[a] == -1 ? to[k] : -2;
		}
	free(start);
	free(to);
	return next;
}

/* Whether the edge from v is that of an eye's lids: it goes round an opening, near the eyeball. loop: out, its vertices; returns how many, 0: no. */
static int lids_edge(int *loop, double middle[2], const struct rig *rig, const int *next, int v)
{
	const int side = rig->side[v];
	const double unit = rig->globe[side].radius / 12;
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	int n = 0;
	for (int i = v; n == 0 || i != v; i = next[i]) {
		double p[3];
		if (next[i] < 0 || n == rig->n || rig->side[i] != side || rig->gap[i] > edge_mm * unit)
			return 0;
		deform_in_head(p, rig, side, rig->rest[i]);
		for (int c = 0; c < 2; c++) {
			low[c] = fmin(low[c], p[c]);
			high[c] = fmax(high[c], p[c]);
		}
		if (!(p[2] > 0))
			return 0;
		loop[n++] = i;
	}
	for (int c = 0; c < 2; c++)
		middle[c] = 0.5 * (low[c] + high[c]);
	return high[0] - low[0] > wide_mm[0] * unit && high[1] - low[1] > wide_mm[1] * unit ? n : 0;
}

/* A place turned by `by` mm over the globe away from the opening's middle. */
static void under_lid(double head[3], const double middle[2], double by)
{
	double out[3], dir[3];
	const double far = vec_norm(head);
	vec_unit(dir, head);
	for (int c = 0; c < 3; c++)
		out[c] = c < 2 ? head[c] - middle[c] : 0;
	vec_add(out, out, -vec_dot(out, dir), dir);
	vec_unit(out, out);
	vec_add(head, head, by, out);
	vec_unit(head, head);
	for (int c = 0; c < 3; c++)
		head[c] *= far;
}

/* Sews to an edge: a wall down to the globe, and from its foot, whose vertices are twice there for their normals, a strip over the globe below the lid. */
static void line_edge(struct lining *m, const struct rig *rig, int n, const int *loop, const double middle[2], const struct rig_conf *conf)
{
	enum { STRIPS = 3, ROWS = 2 + STRIPS };  // a strip as long as all of them would cut into the eyeball between its ends
	const double unit = rig->globe[m->side].radius / 12;
	const int32_t first = m->first + m->n;
	for (int k = 0; k < n; k++)
		for (int row = 0; row < ROWS; row++) {
			double head[3], at[3];
			const double gap = row < 2 ? conf->least : 0.5 * conf->least;
			deform_in_head(head, rig, m->side, rig->rest[loop[k]]);
			if (row >= 2)
				under_lid(head, middle, conf->lining * unit * (row - 1) / STRIPS);
			lining_over_globe(at, rig, m->side, head, fmin(gap, fmax((double)rig->gap[loop[k]], 0)));
			lining_vertex(m, at, gap);
			lining_follow(m, loop[k], 1);
		}
	for (int k = 0; k < n; k++) {
		const int32_t a = loop[k], b = loop[(k + 1) % n], p = first + ROWS * k, q = first + ROWS * ((k + 1) % n);
		lining_face(m, p, b, a);
		lining_face(m, p, q, b);
		for (int row = 1; row + 1 < ROWS; row++) {
			lining_face(m, p + row + 1, q + row, p + row);
			lining_face(m, p + row + 1, q + row + 1, q + row);
		}
	}
}

static void line_lids(struct lining *m, const struct rig *rig, const struct rig_conf *conf)
{
	int *next = edges_of(rig), *loop = mem_array((size_t)rig->n + 1, sizeof *loop);
	bool *seen = mem_new((size_t)rig->n + 1, sizeof *seen);
	for (int v = 0; v < rig->n; v++) {
		double middle[2];
		if (next[v] < 0 || seen[v])
			continue;
		const int n = lids_edge(loop, middle, rig, next, v);
		m->side = rig->side[v];
		if (n)
			line_edge(m, rig, n, loop, middle, conf);
		for (int k = 0; k < n; k++)
			seen[loop[k]] = true;
	}
	free(next);
	free(loop);
	free(seen);
}

void rig_line_lids(struct rig *rig, const struct rig_conf *conf)
{
	struct lining m = { .first = rig->n };
	if (conf->lining > 0)
		line_lids(&m, rig, conf);
	if (conf->caruncle > 0)
		lining_corners(&m, rig, conf);
	if (m.n_faces)
		lining_append(rig, &m);
	free(m.vertex);
	free(m.of);
	free(m.share);
	free(m.faces);
}
