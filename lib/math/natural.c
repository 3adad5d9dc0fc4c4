#include "math/natural.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/natural_delaunay.h"

enum { CAVITY_MAX = NATURAL_MAX };

/* The cavity of a point: the triangles whose circumcircle contains it, which its insertion into the triangulation would remove
 * (Bowyer and Watson). */
struct cavity {
	int n, triangle[CAVITY_MAX];
};

static double side_of(const struct natural *nat, const struct natural_triangle *t, int k, const double q[2])
{
	const double *a = nat->site[t->site[(k + 1) % 3]], *b = nat->site[t->site[(k + 2) % 3]];
	return (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]);
}

/* Walks from triangle to triangle to the one that contains the point; -1 outside the hull. */
static int locate(const struct natural *nat, const double q[2], int from)
{
	int at = from >= 0 && from < nat->n ? from : 0, came = -1;
	for (int steps = 0; steps <= nat->n; steps++) {
		const struct natural_triangle *t = &nat->triangle[at];
		int next = -2;
		for (int k = 0; k < 3 && next == -2; k++)
			if ((t->beyond[k] < 0 || t->beyond[k] != came) && side_of(nat, t, k, q) < 0)
				next = t->beyond[k];
		if (next == -2)
			return at;
		if (next == -1)
			return -1;
		came = at;
		at = next;
	}
	return -1;
}

static bool holds(const struct cavity *c, int triangle)
{
	for (int i = 0; i < c->n; i++)
		if (c->triangle[i] == triangle)
			return true;
	return false;
}

static bool dissolve(struct cavity *c, const struct natural *nat, const double q[2], int first)
{
	c->n = 1;
	c->triangle[0] = first;
	for (int i = 0; i < c->n; i++)
		for (int k = 0; k < 3; k++) {
			int next = nat->triangle[c->triangle[i]].beyond[k];
			if (next < 0 || holds(c, next))
				continue;
			const struct natural_triangle *t = &nat->triangle[next];
			double x = q[0] - t->center[0], y = q[1] - t->center[1];
			if (x * x + y * y >= t->radius2 * (1 - 1e-12))  // on the circle: no area is taken from there
				continue;
			if (c->n == CAVITY_MAX)
				return false;
			c->triangle[c->n++] = next;
		}
	return true;
}

static int corner_of(const struct natural_triangle *t, int site)
{
	return t->site[0] == site ? 0 : t->site[1] == site ? 1 : 2;
}

static double cross(const double o[2], const double a[2], const double b[2])
{
	return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

/* Twice the area that the point's Voronoi cell takes from the cell of site b, where boundary edge (a, b) of the cavity ends: the
 * polygon of circumcentres met when turning about b from (a, b) to the next boundary edge (b, c). */
static double stolen(const struct natural *nat, const struct cavity *cavity, const double q[2], int triangle, int a, int b)
{
	double first[2], last[2], area = 0;
	const double *before = 0;
	natural_circumcenter(first, q, nat->site[a], nat->site[b]);
	for (int guard = 0; guard <= cavity->n; guard++) {
		const struct natural_triangle *t = &nat->triangle[triangle];
		int kb = corner_of(t, b), c = t->site[(kb + 1) % 3], next = t->beyond[(kb + 2) % 3];
		if (before)
			area += cross(first, before, t->center);
		before = t->center;
		if (next < 0 || !holds(cavity, next)) {
			natural_circumcenter(last, q, nat->site[b], nat->site[c]);
			return fabs(area + cross(first, before, last));
		}
		triangle = next;
	}
	return 0;
}

int natural_weights(int site[NATURAL_MAX], double weight[NATURAL_MAX], const struct natural *nat, const double q[2], int *hint)
{
	struct cavity cavity;
	int at = locate(nat, q, *hint), n = 0;
	if (at < 0)
		return 0;
	*hint = at;
	double sum = 0;
	if (!dissolve(&cavity, nat, q, at))
		cavity.n = 1, cavity.triangle[0] = at;
	for (int i = 0; i < cavity.n && n < NATURAL_MAX; i++) {
		const struct natural_triangle *t = &nat->triangle[cavity.triangle[i]];
		for (int k = 0; k < 3 && n < NATURAL_MAX; k++) {
			if (t->beyond[k] >= 0 && holds(&cavity, t->beyond[k]))
				continue;
			// The edge opposite to corner k runs from its next corner to the one after, counter-clockwise.
			int a = t->site[(k + 1) % 3], b = t->site[(k + 2) % 3];
			double x = q[0] - nat->site[b][0], y = q[1] - nat->site[b][1];
			if (x * x + y * y <= 1e-18 * t->radius2) {
				site[0] = b;
				weight[0] = 1;
				return 1;
			}
			site[n] = b;
			weight[n] = stolen(nat, &cavity, q, cavity.triangle[i], a, b);
			sum += weight[n++];
		}
	}
	for (int i = 0; i < n; i++)
		weight[i] /= sum;
	return isfinite(sum) && sum > 0 ? n : 0;
}

struct natural *natural_new(int n, const double (*sites)[2], struct err *err)
{
	struct natural *nat = mem_new(1, sizeof *nat);
	nat->n_sites = n;
	nat->site = mem_new((size_t)(n ? n : 1), sizeof *nat->site);
	memcpy(nat->site, sites, (size_t)n * sizeof *nat->site);
	if (natural_triangulate(nat, err))
		return nat;
	natural_free(nat);
	return 0;
}

void natural_free(struct natural *nat)
{
	if (nat) {
		free(nat->site);
		free(nat->triangle);
		free(nat);
	}
}
