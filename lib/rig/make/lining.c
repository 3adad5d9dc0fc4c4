/* What a character's mesh has not where eye and lids meet: a lining of the lids where it ends at their edges, so that no slit is left beside
 * the eyeball, and in each inner corner a caruncle and the fold beside it, the plica semilunaris. They are vertices and faces of their own,
 * behind all others, which follow the lids (B+ says which vertices) and keep their distance from the globe at every gaze. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/mesh.h"
#include "rig/deform/opening.h"
#include "rig/make/make_impl.h"

/* Of an eyeball of 12 mm, mm. */
static const double edge_mm = 4;            // a mesh's edge so near the eyeball is a lid's
static const double wide_mm[] = { 10, 2 };  // least width and height of what is an eye's opening
static const double near_mm[] = { 0.8, 3 }; // skin so far from a place of the margin tells how it moves: of a normal distribution; at most
static const double crest_mm = 0.28, valley_mm = 0.16, mound_mm = 0.75;  // heights over the globe: of the plica, behind it, of the caruncle
static const double tuck_mm = 1.3;          // how far they go on below the lids
static const double white = 0.6;            // of what is seen of the white at that corner, at most, lies below them
static const double limbus_mm = 5.9;

/* Vertices and faces to be added. of, share: what a vertex follows. */
struct more {
	int n, n_of, n_faces, first, side;  // first: the number of the first
	struct more_vertex {
		float rest[3], gap;
		int side, of;                   // of its followers the first
	} *vertex;
	int *of;
	float *share;
	int32_t (*faces)[3];
};

/* Starts a vertex at that place; whom it follows comes next. Returns its number. */
static int32_t add_vertex(struct more *m, const double rest[3], double gap)
{
	m->vertex = mem_grow(m->vertex, (size_t)m->n + 1, sizeof *m->vertex);
	m->vertex[m->n] = (struct more_vertex){ { (float)rest[0], (float)rest[1], (float)rest[2] }, (float)gap, m->side, m->n_of };
	return m->first + m->n++;
}

static void follow(struct more *m, int vertex, double share)
{
	m->of = mem_grow(m->of, (size_t)m->n_of + 1, sizeof *m->of);
	m->share = mem_grow(m->share, (size_t)m->n_of + 1, sizeof *m->share);
	m->of[m->n_of] = vertex;
	m->share[m->n_of++] = (float)share;
}

/* The first corner has to be a vertex of ours: a face is what its first corner is. */
static void add_face(struct more *m, int32_t a, int32_t b, int32_t c)
{
	m->faces = mem_grow(m->faces, (size_t)m->n_faces + 1, sizeof *m->faces);
	memcpy(m->faces[m->n_faces++], (int32_t[3]){ a, b, c }, sizeof *m->faces);
}

static void *longer(void *p, int had, int more, size_t size)
{
	char *out = mem_grow(p, (size_t)(had + more) + 1, size);
	memset(out + (size_t)had * size, 0, ((size_t)more + 1) * size);
	return out;
}

static void lengthen(struct rig *rig, const struct more *m)
{
	const int n = rig->n, k = m->n, entries = rig->bplus.start[n];
	rig->rest = longer(rig->rest, n, k, sizeof *rig->rest);
	rig->normal = longer(rig->normal, n, k, sizeof *rig->normal);
	rig->home = longer(rig->home, n, k, sizeof *rig->home);
	rig->basis = longer(rig->basis, n, k, sizeof *rig->basis);
	rig->fade = longer(rig->fade, n, k, sizeof *rig->fade);
	rig->thickness = longer(rig->thickness, n, k, sizeof *rig->thickness);
	rig->gap = longer(rig->gap, n, k, sizeof *rig->gap);
	rig->glue = longer(rig->glue, n, k, sizeof *rig->glue);
	rig->part = longer(rig->part, n, k, sizeof *rig->part);
	rig->source = longer(rig->source, n, k, sizeof *rig->source);
	rig->side = longer(rig->side, n, k, sizeof *rig->side);
	rig->faces = longer(rig->faces, rig->n_faces, m->n_faces, sizeof *rig->faces);
	rig->bplus.start = longer(rig->bplus.start, n + 1, k, sizeof *rig->bplus.start);
	rig->bplus.column = longer(rig->bplus.column, entries, m->n_of, sizeof *rig->bplus.column);
	rig->bplus.weight = longer(rig->bplus.weight, entries, m->n_of, sizeof *rig->bplus.weight);
}

static void append(struct rig *rig, const struct more *m)
{
	const int n = rig->n, entries = rig->bplus.start[n];
	lengthen(rig, m);
	for (int k = 0; k < m->n; k++) {
		const struct more_vertex *v = &m->vertex[k];
		const int i = n + k, end = k + 1 < m->n ? m->vertex[k + 1].of : m->n_of;
		memcpy(rig->rest[i], v->rest, sizeof rig->rest[i]);
		rig->gap[i] = rig->thickness[i] = v->gap;
		rig->glue[i] = 1;
		rig->part[i] = RIG_LINING;
		rig->source[i] = RIG_EXTRAPOLATED;
		rig->side[i] = (uint8_t)v->side;
		for (int j = v->of; j < end; j++) {
			const int from = m->of[j];
			rig->bplus.column[entries + j] = from;
			rig->bplus.weight[entries + j] = m->share[j];
			rig->fade[i] += m->share[j] * rig->fade[from];
			for (int c = 0; c < 2; c++)
				rig->home[i][c] += m->share[j] * rig->home[from][c];
			for (int c = 0; c < RIG_BASIS; c++)
				rig->basis[i][c] += m->share[j] * rig->basis[from][c];
		}
		rig->bplus.start[i + 1] = entries + end;
	}
	memcpy(rig->faces + rig->n_faces, m->faces, (size_t)m->n_faces * sizeof *rig->faces);
	rig->n += m->n;
	rig->n_faces += m->n_faces;
}

/* Normals of what was added, and of the edge that it is sewn to. */
static void take_normals(struct rig *rig, const struct more *m)
{
	const struct mesh mesh = { rig->n, rig->n_faces, rig->rest, rig->faces, 0 };
	float (*normal)[3] = mesh_normals(&mesh);
	for (int i = 0; i < 3 * m->n_faces; i++) {
		const int v = m->faces[i / 3][i % 3];
		memcpy(rig->normal[v], normal[v], sizeof rig->normal[v]);
	}
	free(normal);
}

/* A place over an eye's globe in a direction of the head's axes: so far from its surface. */
static void over_globe(double out[3], const struct rig *rig, int side, const double head[3], double gap)
{
	const struct rig_globe *g = &rig->globe[side];
	double dir[3], d[3];
	vec_unit(dir, head);
	mat_tvec(d, rig->head_from_target, dir);
	const double far = (double)globe_map_at(&g->map, (float[3]){ (float)dir[0], (float)dir[1], (float)dir[2] }) + gap;
	for (int c = 0; c < 3; c++)
		out[c] = g->center[c] + far * d[c];
}

/* ---- lids' lining ---- */

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
static void line_edge(struct more *m, const struct rig *rig, int n, const int *loop, const double middle[2], const struct rig_conf *conf)
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
			over_globe(at, rig, m->side, head, fmin(gap, fmax((double)rig->gap[loop[k]], 0)));
			add_vertex(m, at, gap);
			follow(m, loop[k], 1);
		}
	for (int k = 0; k < n; k++) {
		const int32_t a = loop[k], b = loop[(k + 1) % n], p = first + ROWS * k, q = first + ROWS * ((k + 1) % n);
		add_face(m, p, b, a);
		add_face(m, p, q, b);
		for (int row = 1; row + 1 < ROWS; row++) {
			add_face(m, p + row + 1, q + row, p + row);
			add_face(m, p + row + 1, q + row + 1, q + row);
		}
	}
}

static void line_lids(struct more *m, const struct rig *rig, const struct rig_conf *conf)
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

/* ---- caruncle and plica ---- */

enum { ALONG = 11, ACROSS = 9 };  // columns from the corner towards the iris, rows from the lower lid up

/* The inner corner as the front sees it at rest: mm about the eyeball's centre, the head's axes. */
struct corner {
	const struct rig *rig;
	const struct deform_opening *open;
	int side, inner;      // column of the opening nearest to the nose
	double unit, width;   // of caruncle and plica, mm
};

/* Away from the nose. */
static int away(const struct corner *k)
{
	return k->side ? -1 : 1;
}

/* Heights of the lids' margins s mm from the corner; before it both lids lie at its middle. */
static void lids_at(double y[2], const struct corner *k, double s)
{
	const double i = fmax(s, 0) / k->open->step;
	const int a = k->inner + away(k) * (int)i, b = a + away(k);
	const double u = i - floor(i);
	y[0] = k->open->bottom[a] + u * (k->open->bottom[b] - k->open->bottom[a]);
	y[1] = k->open->top[a] + u * (k->open->top[b] - k->open->top[a]);
}

/* A direction from the front's place. */
static void place_of(double head[3], const struct corner *k, double s, double y)
{
	const double x = k->open->step * (k->inner - DEFORM_COLUMNS / 2) + away(k) * s, most = 0.98 * k->rig->globe[k->side].radius, off = fmax(hypot(x, y) / most, 1);
	head[0] = x / off;
	head[1] = y / off;
	head[2] = sqrt(fmax(k->rig->globe[k->side].radius * k->rig->globe[k->side].radius - head[0] * head[0] - head[1] * head[1], 0));
}

/* How the lid of that margin moves at a place: the mean of its skin near it. share: of all. */
static void follow_lid(struct more *m, const struct corner *k, double s, bool upper, double share)
{
	const struct rig *rig = k->rig;
	double y[2], head[3], all = 0, middle;
	float at[3];
	lids_at(y, k, s);
	middle = 0.5 * (y[0] + y[1]);
	place_of(head, k, fmax(s, 0), y[upper]);
	double p[3];
	over_globe(p, rig, k->side, head, 0.5 * k->unit);
	for (int c = 0; c < 3; c++)
		at[c] = (float)p[c];
	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < rig->n; i++) {
			double q[3], d[3];
			if (rig->part[i] != RIG_SKIN || rig->side[i] != k->side || rig->gap[i] > near_mm[1] * k->unit)
				continue;
			for (int c = 0; c < 3; c++)
				d[c] = rig->rest[i][c] - at[c];
			const double off = vec_norm(d) / k->unit;
			if (off > near_mm[1])
				continue;
			deform_in_head(q, rig, k->side, rig->rest[i]);
			const double beside = (upper ? q[1] - middle : middle - q[1]) / k->unit, own = fmin(fmax(0.5 + beside, 0.02), 1);
			const double w = own * exp(-0.5 * off * off / (near_mm[0] * near_mm[0]));
			if (pass == 0)
				all += w;
			else if (w > 1e-4 * all)
				follow(m, i, share * w / all);
		}
}

static double smooth_step(double x, double from, double to)
{
	const double t = fmin(fmax((x - from) / (to - from), 0), 1);
	return t * t * (3 - 2 * t);
}

/* Height over the globe: r 0 at the corner, 1 at the plica's edge; t 0 at the lower margin, 1 at the upper one. */
static double height_at(const struct corner *k, double r, double t, double least)
{
	const double along = fmin(fmax(t, 0), 1), round = sqrt(fmax(1 - (2 * along - 1) * (2 * along - 1), 0));
	const double plica = crest_mm * smooth_step(r, 1, 0.86) * (1 - smooth_step(r, 0.86, 0.62)) + valley_mm * (1 - smooth_step(r, 0.6, 0.9));
	const double mound = (mound_mm - valley_mm) * (1 - smooth_step(r, 0.12, 0.62)) * smooth_step(r, -0.5, 0.05);
	return fmax(k->unit * (plica * (0.4 + 0.6 * round) + mound * round), least);
}

static void add_corner(struct more *m, const struct corner *k, const struct rig_conf *conf)
{
	const double tuck = tuck_mm * k->unit;
	const int32_t first = m->first + m->n;
	for (int j = 0; j < ALONG; j++)
		for (int i = 0; i < ACROSS; i++) {
			// The rows beside the first and the last, and the first column, lie below the lids.
			const double t = (double)(i - 1) / (ACROSS - 3), u = 2 * fmin(fmax(t, 0), 1) - 1, edge = k->width * (0.72 + 0.28 * u * u);
			const double s = j == 0 ? -tuck : edge * (j - 1) / (ALONG - 2);
			double y[2], head[3], at[3];
			lids_at(y, k, s);
			const double inside = fmin(fmax(t, 0), 1), height = y[0] + inside * (y[1] - y[0]) + (t < 0 ? -tuck : t > 1 ? tuck : 0);
			const bool below = t < 0 || t > 1;
			const double gap = below ? conf->least : height_at(k, s / edge, t, conf->least);
			place_of(head, k, s, height);
			over_globe(at, k->rig, k->side, head, gap);
			add_vertex(m, at, gap);
			if (inside < 1)
				follow_lid(m, k, s, false, 1 - inside);
			if (inside > 0)
				follow_lid(m, k, s, true, inside);
		}
	for (int j = 0; j + 1 < ALONG; j++)
		for (int i = 0; i + 1 < ACROSS; i++) {
			const int32_t a = first + j * ACROSS + i, b = a + ACROSS, c = a + 1, d = b + 1;
			add_face(m, a, k->side ? c : b, k->side ? b : c);
			add_face(m, d, k->side ? b : c, k->side ? c : b);
		}
}

static void line_corners(struct more *m, const struct rig *rig, const struct rig_conf *conf)
{
	enum { LEAST = 20 };
	struct deform_near near = deform_near_of(rig);
	for (int side = 0; side < 2; side++) {
		const struct deform_opening *o = &near.rest[side];
		struct corner k = { rig, o, side, side ? o->last : o->first, rig->globe[side].radius / 12, 0 };
		if (o->last - o->first < LEAST)
			continue;
		const double end = fabs(o->step * (k.inner - DEFORM_COLUMNS / 2)), all = (o->last - o->first) * o->step;
		k.width = fmin(fmin(conf->caruncle * k.unit, white * (end - limbus_mm * k.unit)), 0.3 * all);
		m->side = side;
		if (k.width > 4 * o->step)
			add_corner(m, &k, conf);
	}
	deform_near_free(&near);
}

void rig_line_lids(struct rig *rig, const struct rig_conf *conf)
{
	struct more m = { .first = rig->n };
	if (conf->lining > 0)
		line_lids(&m, rig, conf);
	if (conf->caruncle > 0)
		line_corners(&m, rig, conf);
	if (m.n_faces) {
		append(rig, &m);
		take_normals(rig, &m);
	}
	free(m.vertex);
	free(m.of);
	free(m.share);
	free(m.faces);
}
