#include "draw/eye/vessels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"

enum { NODES_MAX = 40000, STEPS_MAX = 2000, ENDS_MAX = 300 };
static const double MARGIN = 0.3;        // mm: twigs end so far from the limbus
static const double FARTHEST = 1.9;      // rad from the axis: beyond, no picture shows them
static const double PERSISTS = 0.8;      // share of a twig's way that its last step has
static const double FORWARDS = 0.5;      // and the way to the limbus: vessels fork at acute angles
static const double SHOWN_LEAST = 0.25;

/* A point that wants blood, and the node nearest to it. */
struct point {
	double at[3], away;
	int node;
};

struct grower {
	const struct vessel_habit *habit;
	struct rng rng;
	struct vessels tree;
	int n_points;
	struct point *point;
	double (*drawn)[3];   // [node]: sum of the directions in which it is drawn
	double (*last)[3];    // [node]: the way it came
};

static void put(double at[3], double polar, double turn)
{
	at[0] = sin(polar) * cos(turn);
	at[1] = sin(polar) * sin(turn);
	at[2] = -cos(polar);
}

static double apart(const double a[3], const double b[3])
{
	double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
	return vec_norm(d);
}

static int add(struct grower *g, const double at[3], int parent)
{
	struct vessels *t = &g->tree;
	t->node[t->n] = (struct vessel_node){ .parent = parent };
	memcpy(t->node[t->n].at, at, sizeof t->node[t->n].at);
	for (int i = 0; i < 3; i++)
		g->last[t->n][i] = parent < 0 ? 0 : at[i] - t->node[parent].at[i];
	return t->n++;
}

/* Place of a direction in a map `size` texels wide, azimuthal equidistant about the axis, whose edge is `reach` from it. */
static void in_map(double xy[2], const double at[3], int size, double reach)
{
	double flat = hypot(at[0], at[1]), r = 0.5 * size / reach * atan2(flat, -at[2]), per = flat > 0 ? r / flat : 0;
	for (int i = 0; i < 2; i++)
		xy[i] = 0.5 * size + per * at[i];
}

static bool is_seen(const struct vessel_habit *h, const double at[3])
{
	double xy[2];
	if (!h->seen)
		return false;
	const int n = h->seen->width;
	in_map(xy, at, n, h->seen_reach);
	return image_at(h->seen, (int)fmin(fmax(xy[0], 0), n - 1), (int)fmin(fmax(xy[1], 0), n - 1))[1] > 0.5f;
}

/* Where the photograph's vessels leave what it shows: the strongest first come, at least a step apart. */
static void sow_ends(struct grower *g)
{
	const struct vessel_habit *h = g->habit;
	const int n = h->seen->width;
	for (float least = 0.6f; least > 0.2f; least -= 0.2f)
		for (int y = 0; y < n; y++)
			for (int x = 0; x < n; x++) {
				const float *p = image_at(h->seen, x, y);
				if (p[1] < 0.3f || p[1] > 0.7f || p[0] < least || g->n_points >= ENDS_MAX)
					continue;
				double u = (x + 0.5) / n - 0.5, v = (y + 0.5) / n - 0.5, at[3], nearest = INFINITY;
				put(at, 2 * h->seen_reach * hypot(u, v), atan2(v, u));
				for (int i = 0; i < g->n_points; i++)
					nearest = fmin(nearest, apart(at, g->point[i].at) * h->radius);
				if (nearest < h->step)
					continue;
				memcpy(g->point[g->n_points].at, at, sizeof at);
				g->point[g->n_points++].away = INFINITY;
			}
}

/* Roots come in from the corners of the eye, some from above and below; more points lie to the sides, too. */
static void sow(struct grower *g)
{
	const struct vessel_habit *h = g->habit;
	for (int i = 0; i < h->roots; i++) {
		double at[3], side = i % 2 ? M_PI : 0, turn = i % 5 == 4 ? side + M_PI / 2 : side;
		put(at, FARTHEST, turn + 0.55 * rng_normal(&g->rng));
		add(g, at, -1);
	}
	const double top = cos(h->limbus + MARGIN / h->radius), low = cos(FARTHEST);
	if (h->seen && h->points)
		sow_ends(g);
	for (int i = 0; i < h->points; i++) {
		double turn = 2 * M_PI * rng_uniform(&g->rng), c = cos(turn), polar = acos(rng_range(&g->rng, low, top));
		put(g->point[g->n_points].at, polar, turn);
		if (rng_uniform(&g->rng) > 0.4 + 0.6 * c * c || is_seen(h, g->point[g->n_points].at))
			continue;
		g->point[g->n_points++].away = INFINITY;
	}
}

/* Points look at the nodes from `from` on; those that have blood are gone. */
static void look(struct grower *g, int from)
{
	int left = 0;
	for (int i = 0; i < g->n_points; i++) {
		struct point *p = &g->point[i];
		for (int k = from; k < g->tree.n; k++) {
			double d = apart(p->at, g->tree.node[k].at);
			if (d < p->away) {
				p->away = d;
				p->node = k;
			}
		}
		if (p->away * g->habit->radius > g->habit->near)
			g->point[left++] = *p;
	}
	g->n_points = left;
}

/* A twig from a node, drawn in a direction; false: it would lie where one is, or on the cornea. */
static bool sprout(struct grower *g, int k, const double drawn[3])
{
	const struct vessel_habit *h = g->habit;
	double way[3], at[3], last[3];
	memcpy(way, drawn, sizeof way);
	memcpy(last, g->last[k], sizeof last);
	vec_unit(way, way);
	if (vec_norm(last) > 0) {
		vec_unit(last, last);
		vec_add(way, way, PERSISTS, last);
	}
	way[2] -= FORWARDS;
	for (int i = 0; i < 3; i++)
		way[i] += 0.25 * rng_normal(&g->rng);
	vec_add(way, way, -vec_dot(way, g->tree.node[k].at), g->tree.node[k].at);
	vec_unit(way, way);
	vec_add(at, g->tree.node[k].at, h->step / h->radius, way);
	vec_unit(at, at);
	if (acos(fmin(-at[2], 1)) < h->limbus + MARGIN / h->radius)
		return false;
	for (int i = k + 1; i < g->tree.n; i++)
		if (g->tree.node[i].parent == k && apart(g->tree.node[i].at, at) * h->radius < 0.5 * h->step)
			return false;
	add(g, at, k);
	return true;
}

/* Where points to both sides draw a node to where it has a twig already: towards the nearest of them alone; what cannot be come nearer to wants no more. */
static void to_nearest(struct grower *g, int k)
{
	struct point *nearest = 0;
	for (int i = 0; i < g->n_points; i++)
		if (g->point[i].node == k && (!nearest || g->point[i].away < nearest->away))
			nearest = &g->point[i];
	double way[3];
	for (int c = 0; c < 3; c++)
		way[c] = nearest->at[c] - g->tree.node[k].at[c];
	if (!sprout(g, k, way))
		nearest->away = 0;
}

static void grow(struct grower *g)
{
	look(g, 0);
	for (int step = 0; step < STEPS_MAX && g->n_points; step++) {
		const int before = g->tree.n;
		memset(g->drawn, 0, (size_t)before * sizeof *g->drawn);
		for (int i = 0; i < g->n_points; i++) {
			const struct point *p = &g->point[i];
			if (p->away * g->habit->radius > g->habit->reach)
				continue;
			for (int c = 0; c < 3; c++)
				g->drawn[p->node][c] += (p->at[c] - g->tree.node[p->node].at[c]) / p->away;
		}
		for (int k = 0; k < before && g->tree.n < NODES_MAX; k++)
			if (vec_norm(g->drawn[k]) > 0 && !sprout(g, k, g->drawn[k]))
				to_nearest(g, k);
		const int wanting = g->n_points;
		look(g, before);
		if (g->tree.n == before && g->n_points == wanting)
			return;
	}
}

/* Murray's widths; how deep each branch lies: a child's depth is near its parent's. */
static void widen(struct grower *g)
{
	struct vessels *t = &g->tree;
	for (int k = t->n - 1; k >= 0; k--) {
		struct vessel_node *v = &t->node[k];
		v->width = cbrt(fmax(v->width, pow(g->habit->width, 3)));  // the sum of the children's cubes so far
		if (v->parent >= 0)
			t->node[v->parent].width += pow(v->width, 3);
	}
	for (int k = 0; k < t->n; k++) {
		struct vessel_node *v = &t->node[k];
		double from = v->parent < 0 ? rng_range(&g->rng, 0.6, 1) : t->node[v->parent].shown;
		v->shown = fmin(fmax(from + 0.05 * rng_normal(&g->rng), SHOWN_LEAST), 1);
	}
}

/* Vessels wind: each node is moved aside along its chain; one that branches off begins where its parent has gone, and winds by itself from there. */
static void wind(struct grower *g)
{
	const struct vessel_habit *h = g->habit;
	struct vessels *t = &g->tree;
	double (*moved)[3] = mem_new((size_t)t->n + 1, sizeof *moved), *along = mem_new((size_t)t->n + 1, sizeof *along), *phase = mem_new((size_t)t->n + 1, sizeof *phase);
	int *thickest = mem_array((size_t)t->n + 1, sizeof *thickest);
	for (int k = 0; k < t->n; k++)
		thickest[k] = -1;
	for (int k = t->n - 1; k >= 0; k--) {
		int p = t->node[k].parent;
		if (p >= 0 && (thickest[p] < 0 || t->node[k].width >= t->node[thickest[p]].width))
			thickest[p] = k;
	}
	for (int k = 0; k < t->n; k++) {
		const struct vessel_node *v = &t->node[k];
		const int p = v->parent;
		const bool goes_on = p >= 0 && thickest[p] == k;
		along[k] = goes_on ? along[p] + h->step : 0;
		phase[k] = goes_on ? phase[p] + 0.15 * rng_normal(&g->rng) : rng_range(&g->rng, 0, 2 * M_PI);
		if (p < 0)
			continue;
		double side[3], ramp = fmin(along[k] / h->wave, 1), turn = 2 * M_PI * along[k] / h->wave;
		vec_cross(side, v->at, g->last[k]);
		vec_unit(side, side);
		double to = h->sway * ramp * (0.7 * (sin(turn + phase[k]) - sin(phase[k])) + 0.3 * sin(2.3 * turn + 1.7 * phase[k]));
		for (int i = 0; i < 3; i++)
			moved[k][i] = 0.75 * moved[p][i] + 0.25 * to / h->radius * side[i];
	}
	for (int k = 0; k < t->n; k++) {
		vec_add(t->node[k].at, t->node[k].at, 1, moved[k]);
		vec_unit(t->node[k].at, t->node[k].at);
	}
	free(moved);
	free(along);
	free(phase);
	free(thickest);
}

struct vessels vessels_grow(const struct vessel_habit *habit, uint64_t seed)
{
	struct grower g = { .habit = habit, .rng = { seed } };
	g.tree.node = mem_new(NODES_MAX, sizeof *g.tree.node);
	g.point = mem_new((size_t)habit->points + ENDS_MAX + 1, sizeof *g.point);
	g.drawn = mem_new(NODES_MAX, sizeof *g.drawn);
	g.last = mem_new(NODES_MAX, sizeof *g.last);
	sow(&g);
	grow(&g);
	widen(&g);
	wind(&g);
	free(g.point);
	free(g.drawn);
	free(g.last);
	return g.tree;
}

void vessels_free(struct vessels *vessels)
{
	free(vessels->node);
	*vessels = (struct vessels){ 0 };
}

struct stroke {
	double at[2], width, ink;
};

/* A straight piece whose width goes from a's to b's, px. */
static void piece(struct image *cover, const struct stroke *a, const struct stroke *b)
{
	double dx = b->at[0] - a->at[0], dy = b->at[1] - a->at[1], len2 = fmax(dx * dx + dy * dy, 1e-12), reach = 0.5 * fmax(fmax(a->width, b->width), 1) + 1;
	int x0 = (int)fmax(fmin(a->at[0], b->at[0]) - reach, 0), x1 = (int)fmin(fmax(a->at[0], b->at[0]) + reach, cover->width - 1);
	int y0 = (int)fmax(fmin(a->at[1], b->at[1]) - reach, 0), y1 = (int)fmin(fmax(a->at[1], b->at[1]) + reach, cover->height - 1);
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			double px = x + 0.5 - a->at[0], py = y + 0.5 - a->at[1], t = fmin(fmax((px * dx + py * dy) / len2, 0), 1);
			double off = hypot(px - t * dx, py - t * dy), width = a->width + t * (b->width - a->width);
			double share = fmin(width, 1) * fmin(fmax(0.5 * fmax(width, 1) + 0.5 - off, 0), 1) * (a->ink + t * (b->ink - a->ink));
			float *p = image_at(cover, x, y);
			*p = fmaxf(*p, (float)share);
		}
}

static struct stroke stroke_of(const struct vessel_node *v, int size, double reach, double radius)
{
	struct stroke s = { .width = v->width * 0.5 * size / (reach * radius), .ink = v->shown };
	in_map(s.at, v->at, size, reach);
	return s;
}

void vessels_draw(struct image *cover, const struct vessels *vessels, double reach, double radius)
{
	for (int k = 0; k < vessels->n; k++) {
		const struct vessel_node *v = &vessels->node[k];
		if (v->parent < 0)
			continue;
		struct stroke a = stroke_of(&vessels->node[v->parent], cover->width, reach, radius), b = stroke_of(v, cover->width, reach, radius);
		a.width = fmin(a.width, 1.3 * b.width);  // a branch does not begin as wide as what it leaves
		piece(cover, &a, &b);
	}
}
