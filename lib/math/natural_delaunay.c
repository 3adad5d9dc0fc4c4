#include "math/natural_delaunay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <libqhull_r/qhull_ra.h>

#include "base/mem.h"

void natural_circumcenter(double out[2], const double a[2], const double b[2], const double c[2])
{
	double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
	double d = 2 * (bx * cy - by * cx), bb = bx * bx + by * by, cc = cx * cx + cy * cy;
	out[0] = a[0] + (cy * bb - by * cc) / d;
	out[1] = a[1] + (bx * cc - cx * bb) / d;
}

static double turn(const double a[2], const double b[2], const double c[2])
{
	return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Takes the Delaunay triangles from Qhull: the lower faces of the convex hull of the sites lifted onto a paraboloid. */
static void take_facets(struct natural *nat, qhT *qh)
{
	facetT *facet;
	vertexT *vertex, **vertexp;
	nat->triangle = mem_new((size_t)qh->num_facets, sizeof *nat->triangle);
	FORALLfacets {
		int k = 0;
		struct natural_triangle t = { .beyond = { -1, -1, -1 } };
		if (facet->upperdelaunay)
			continue;
		FOREACHvertex_(facet->vertices)
			if (k < 3)
				t.site[k++] = qh_pointid(qh, vertex->point);
		const double *a = nat->site[t.site[0]], *b = nat->site[t.site[1]], *c = nat->site[t.site[2]];
		double side = k == 3 ? turn(a, b, c) : 0;
		if (side == 0)  // a sliver of Qhull's merging
			continue;
		if (side < 0) {
			int s = t.site[1];
			t.site[1] = t.site[2];
			t.site[2] = s;
		}
		natural_circumcenter(t.center, a, b, c);
		t.radius2 = (a[0] - t.center[0]) * (a[0] - t.center[0]) + (a[1] - t.center[1]) * (a[1] - t.center[1]);
		nat->triangle[nat->n++] = t;
	}
}

struct edge {
	int lo, hi, triangle, corner;
};

static int by_ends(const void *a, const void *b)
{
	const struct edge *p = a, *q = b;
	if (p->lo != q->lo)
		return p->lo < q->lo ? -1 : 1;
	if (p->hi != q->hi)
		return p->hi < q->hi ? -1 : 1;
	return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static void join(struct natural *nat)
{
	size_t n = 3 * (size_t)nat->n;
	struct edge *edges = mem_new(n, sizeof *edges);
	for (int t = 0; t < nat->n; t++)
		for (int k = 0; k < 3; k++) {
			int a = nat->triangle[t].site[(k + 1) % 3], b = nat->triangle[t].site[(k + 2) % 3];
			edges[3 * t + k] = (struct edge){ a < b ? a : b, a < b ? b : a, t, k };
		}
	qsort(edges, n, sizeof *edges, by_ends);
	for (size_t i = 0; i + 1 < n; i++) {
		const struct edge *p = &edges[i], *q = p + 1;
		if (p->lo != q->lo || p->hi != q->hi)
			continue;
		nat->triangle[p->triangle].beyond[p->corner] = q->triangle;
		nat->triangle[q->triangle].beyond[q->corner] = p->triangle;
	}
	free(edges);
}

bool natural_triangulate(struct natural *nat, struct err *err)
{
	qhT state, *qh = &state;
	char *said = 0;
	size_t size = 0;
	FILE *sink = open_memstream(&said, &size);
	int curlong, totlong, rest = 1;
	qh_zero(qh, sink);
	// Qz adds a point at infinity for sites on one circle, Qbb scales the paraboloid, Qt cuts what lies on one circle.
	char command[] = "qhull d Qbb Qc Qz Qt";
	if (nat->n_sites >= 3)
		rest = qh_new_qhull(qh, 2, nat->n_sites, &nat->site[0][0], False, command, 0, sink);
	if (!rest)
		take_facets(nat, qh);
	if (nat->n_sites >= 3) {
		qh_freeqhull(qh, !qh_ALL);
		qh_memfreeshort(qh, &curlong, &totlong);
	}
	fclose(sink);
	free(said);
	if (rest || !nat->n)
		return err_set(err, "%d points span no area: nothing can be interpolated between them", nat->n_sites);
	join(nat);
	return true;
}
