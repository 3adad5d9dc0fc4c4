#include "rig/deform/cards.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/closest.h"
#include "mesh/topology.h"

/* Of an eyeball of 12 mm, mm. */
static const double stands_mm = 1;         // a card's roots are so near the skin
static const double off_mm = 2;            // and something of it is so far off: a film of tears is none
static const double longest_mm = 25;       // and nothing further
static const double about_mm = 42;         // from an eyeball's centre: lashes and brows, no teeth and no hair of the head
static const double patch_mm = 3;          // skin so far from a root tells how it is turned
static const double spread_mm = 0.7;       // roots so far beside a vertex' own lead it, too: of a normal distribution
static const double apart_mm = 0.3;        // roots of a piece are no nearer to each other
static const double low_share = 0.25;      // of a piece's height over the skin: roots are below it

/* The skin, and a way to find it. */
struct ground {
	const struct rig *rig;
	struct topology about;          // of the whole mesh
	struct mesh mesh;               // the skin's faces; the rig's vertices
	struct closest_scene *scene;
};

static struct closest_point onto(const struct ground *g, const float p[3])
{
	return closest_find(g->scene, p, 0, 0, INFINITY, -1);
}

static void ground_make(struct ground *g, const struct rig *rig, const int *piece, int skin)
{
	*g = (struct ground){ .rig = rig, .mesh = { .n_vertices = rig->n, .vertices = rig->rest, .faces = mem_array((size_t)rig->n_faces + 1, sizeof *g->mesh.faces) } };
	topology_make(&g->about, &(struct mesh){ .n_vertices = rig->n, .n_faces = rig->n_faces, .vertices = rig->rest, .faces = rig->faces });
	for (int f = 0; f < rig->n_faces; f++) {
		const int32_t *v = rig->faces[f];
		bool is_skin = false;
		for (int k = 0; k < 3; k++)
			is_skin = is_skin || (piece[v[k]] == skin && rig->part[v[k]] == RIG_SKIN);
		if (is_skin)
			memcpy(g->mesh.faces[g->mesh.n_faces++], v, sizeof *g->mesh.faces);
	}
	g->scene = closest_new(&g->mesh, 0);
}

static void ground_free(struct ground *g)
{
	closest_free(g->scene);
	topology_free(&g->about);
	free(g->mesh.faces);
}

static double apart(const struct rig *rig, int i, const double at[3])
{
	const double d[3] = { (double)rig->rest[i][0] - at[0], (double)rig->rest[i][1] - at[1], (double)rig->rest[i][2] - at[2] };
	return vec_norm(d);
}

/* Vertices of the skin by how far they are from a place. */
struct found {
	int n;
	struct beside {
		double off;
		int vertex;
	} of[256];
};

static void find(struct found *found, const struct ground *g, int vertex, const double at[3], double reach)
{
	const double off = apart(g->rig, vertex, at);
	bool there = found->n == COUNT(found->of) || g->rig->part[vertex] != RIG_SKIN || (found->n >= 3 && !(off < reach));
	for (int k = 0; k < found->n && !there; k++)
		there = found->of[k].vertex == vertex;
	if (!there)
		found->of[found->n++] = (struct beside){ off, vertex };
}

static int nearer_first(const void *p, const void *q)
{
	const struct beside *a = p, *b = q;
	return a->off != b->off ? (a->off > b->off) - (a->off < b->off) : a->vertex - b->vertex;
}

/* The skin about a place of a face: that face's corners, and what its edges lead to within reach. */
static struct deform_root root_of(const struct ground *g, const struct closest_point *on, double reach)
{
	struct deform_root r = { .n = 3 };
	struct found found = { 0 };
	const int32_t *v = g->mesh.faces[on->face];
	for (int k = 0; k < 3; k++) {
		r.at[k] = (double)on->at[k];
		r.vertex[k] = v[k];
		r.foot[k] = on->bary[k];
	}
	for (int k = 0; k < 3; k++)
		find(&found, g, v[k], r.at, reach);
	for (int k = 0; k < found.n; k++)
		for (int j = g->about.start[found.of[k].vertex]; j < g->about.start[found.of[k].vertex + 1]; j++)
			find(&found, g, g->about.neighbour[j], r.at, reach);
	qsort(found.of, (size_t)found.n, sizeof *found.of, nearer_first);
	for (int k = 0; k < found.n && r.n < DEFORM_PATCH; k++)
		if (found.of[k].vertex != v[0] && found.of[k].vertex != v[1] && found.of[k].vertex != v[2])
			r.vertex[r.n++] = found.of[k].vertex;
	for (int k = 0; k < r.n; k++)
		r.weight[k] = (float)exp(-0.5 * pow(2 * fmin(apart(g->rig, r.vertex[k], r.at) / reach, 1), 2));
	return r;
}

/* The roots that lead a vertex, of the n from `first` on. */
static struct deform_carried carried_by(const struct rig *rig, int vertex, const struct deform_root *root, int first, int n, double unit)
{
	struct deform_carried out = { .vertex = vertex };
	double d[DEFORM_ROOTS], sum = 0;
	for (int k = first; k < first + n; k++) {
		const double off = apart(rig, vertex, root[k].at);
		int at = out.n < DEFORM_ROOTS ? out.n++ : off < d[DEFORM_ROOTS - 1] ? DEFORM_ROOTS - 1 : -1;
		if (at < 0)
			continue;
		for (; at > 0 && d[at - 1] > off; at--) {
			d[at] = d[at - 1];
			out.root[at] = out.root[at - 1];
		}
		d[at] = off;
		out.root[at] = k;
	}
	for (int k = 0; k < out.n; k++)
		sum += out.weight[k] = (float)exp(-0.5 * (d[k] * d[k] - d[0] * d[0]) / pow(spread_mm * unit, 2));
	for (int k = 0; k < out.n; k++)
		out.weight[k] /= (float)sum;
	return out;
}

/* What is known of a piece of the mesh: its vertices' distances from the skin. */
struct piece {
	int n;
	bool moves, near;     // all of it; to an eye
	float least, most;
};

/* Returns whether any is near an eye, and moves. */
static bool look_at_pieces(struct piece *of, const struct rig *rig, const int *piece, int skin, const bool *moves)
{
	bool any = false;
	for (int i = 0; i < rig->n; i++) {
		struct piece *p = &of[piece[i]];
		const struct rig_globe *globe = &rig->globe[rig->side[i]];
		if (piece[i] == skin)
			continue;
		if (!p->n++)
			*p = (struct piece){ .n = 1, .moves = true, .near = true, .least = INFINITY };
		p->moves = p->moves && moves[i] && (rig->part[i] == RIG_SKIN || rig->part[i] == RIG_NEAR_EYE);
		p->near = p->near && p->moves && apart(rig, i, globe->center) < about_mm * globe->radius / 12;
	}
	for (int i = 0; i < rig->n; i++)
		any = any || (of[i].n && of[i].near);
	return any;
}

static void find_heights(struct piece *of, float *off, const struct ground *g, const int *piece)
{
	for (int i = 0; i < g->rig->n; i++) {
		struct piece *p = &of[piece[i]];
		if (!p->n || !p->near)
			continue;
		const struct closest_point on = onto(g, g->rig->rest[i]);
		off[i] = on.face < 0 ? INFINITY : on.distance;
		p->least = fminf(p->least, off[i]);
		p->most = fmaxf(p->most, off[i]);
	}
}

/* Whether one of the roots from `first` on is there already. */
static bool near_another(const struct deform_cards *cards, int first, const float at[3], double reach)
{
	for (int k = first; k < cards->n_roots; k++) {
		const double *r = cards->root[k].at, d[3] = { r[0] - (double)at[0], r[1] - (double)at[1], r[2] - (double)at[2] };
		if (vec_norm(d) < reach)
			return true;
	}
	return false;
}

static void take(struct deform_cards *cards, const struct ground *g, const int *member, int n, const float *off, const struct piece *p)
{
	const struct rig *rig = g->rig;
	const double unit = rig->globe[rig->side[member[0]]].radius / 12, low = p->least + low_share * (p->most - p->least);
	const int first = cards->n_roots;
	for (int k = 0; k < n; k++) {
		if (!(off[member[k]] <= low))
			continue;
		const struct closest_point on = onto(g, rig->rest[member[k]]);
		if (near_another(cards, first, on.at, apart_mm * unit))
			continue;
		cards->root = mem_grow(cards->root, (size_t)cards->n_roots + 1, sizeof *cards->root);
		cards->root[cards->n_roots++] = root_of(g, &on, patch_mm * unit);
	}
	cards->carried = mem_grow(cards->carried, (size_t)(cards->n + n), sizeof *cards->carried);
	for (int k = 0; k < n; k++)
		cards->carried[cards->n++] = carried_by(rig, member[k], cards->root, first, cards->n_roots - first, unit);
}

/* The largest piece of skin. -1: there is none. */
static int largest(const struct rig *rig, const int *piece)
{
	int *n = mem_new((size_t)rig->n + 1, sizeof *n), best = -1;
	for (int i = 0; i < rig->n; i++)
		if (rig->part[i] == RIG_SKIN && ++n[piece[i]] > (best < 0 ? 0 : n[best]))
			best = piece[i];
	free(n);
	return best;
}

/* Those among the pieces that stand on the skin. */
static void take_standing(struct deform_cards *cards, struct piece *of, const struct rig *rig, const int *piece, int skin)
{
	struct ground g;
	int *member = mem_array((size_t)rig->n + 1, sizeof *member), *start = mem_new((size_t)rig->n + 2, sizeof *start);
	float *off = mem_new((size_t)rig->n + 1, sizeof *off);
	ground_make(&g, rig, piece, skin);
	find_heights(of, off, &g, piece);
	for (int i = 0; i < rig->n; i++)
		start[piece[i] + 2]++;
	for (int i = 2; i <= rig->n + 1; i++)
		start[i] += start[i - 1];
	for (int i = 0; i < rig->n; i++)
		member[start[piece[i] + 1]++] = i;
	for (int i = 0; i < rig->n; i++) {
		const double unit = rig->globe[rig->side[i]].radius / 12;
		if (of[i].n && of[i].near && of[i].least < stands_mm * unit && of[i].most > off_mm * unit && of[i].most < longest_mm * unit)
			take(cards, &g, member + start[i], start[i + 1] - start[i], off, &of[i]);
	}
	free(off);
	free(start);
	free(member);
	ground_free(&g);
}

struct deform_cards deform_cards_of(const struct rig *rig, const bool *moves)
{
	struct deform_cards cards = { 0 };
	int *piece = mesh_pieces(rig->n, rig->n_faces, (const int32_t(*)[3])rig->faces);
	struct piece *of = mem_new((size_t)rig->n + 1, sizeof *of);
	const int skin = largest(rig, piece);
	if (skin >= 0 && look_at_pieces(of, rig, piece, skin, moves))
		take_standing(&cards, of, rig, piece, skin);
	free(of);
	free(piece);
	return cards;
}

void deform_cards_free(struct deform_cards *cards)
{
	free(cards->carried);
	free(cards->root);
	*cards = (struct deform_cards){ 0 };
}
