#include "track/clip/rim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/vec.h"
#include "mesh/topology.h"

/* Width of an opening, radius of an eyeball (people's have 12 mm, characters' up to 16), and the rim's distance from the sphere, rms: mm. */
static const double width_least = 15, width_most = 45, radius_least = 9, radius_most = 18, off_most = 0.7;
static const double near_enough = 20;  // mm, of the hole's middle from a point of the opening

/* For each boundary vertex the lowest of its loop; -1 for others. free(). */
static int *loops(const struct topology *t)
{
	int *loop = mem_array((size_t)t->n + 1, sizeof *loop);
	for (int i = 0; i < t->n; i++)
		loop[i] = t->boundary[i] ? i : -1;
	for (int i = 0; i < t->n_rim; i++) {
		int a = t->rim[i][0], b = t->rim[i][1];
		while (loop[a] != a)
			a = loop[a] = loop[loop[a]];
		while (loop[b] != b)
			b = loop[b] = loop[loop[b]];
		loop[a > b ? a : b] = a > b ? b : a;
	}
	for (int i = 0; i < t->n; i++)
		if (loop[i] >= 0)
			loop[i] = loop[loop[i]];  // a lower vertex, whose own is its root already
	return loop;
}

struct hole {
	double middle[3], center[3], radius, off, width;
};

/* |x|² = 2 x·c + (r² - |c|²), from the middle of the loop. */
static bool fit(struct hole *h, const struct mesh *mesh, const int *loop, int which)
{
	double a[4][4] = { { 0 } }, b[4] = { 0 }, lo = INFINITY, hi = -INFINITY, square = 0;
	int n = 0;
	*h = (struct hole){ 0 };
	for (int i = 0; i < mesh->n_vertices; i++)
		if (loop[i] == which) {
			for (int k = 0; k < 3; k++)
				h->middle[k] += (double)mesh->vertices[i][k];
			lo = fmin(lo, (double)mesh->vertices[i][0]);
			hi = fmax(hi, (double)mesh->vertices[i][0]);
			n++;
		}
	h->width = hi - lo;
	for (int k = 0; k < 3; k++)
		h->middle[k] /= n;
	for (int i = 0; i < mesh->n_vertices; i++) {
		if (loop[i] != which)
			continue;
		double x[4] = { [3] = 1 };
		for (int k = 0; k < 3; k++)
			x[k] = (double)mesh->vertices[i][k] - h->middle[k];
		for (int r = 0; r < 4; r++) {
			for (int c = 0; c < 4; c++)
				a[r][c] += x[r] * x[c];
			b[r] += 0.5 * x[r] * vec_dot(x, x);
		}
	}
	if (n < 8 || !chol_solve(4, 4, &a[0][0], b))
		return false;
	h->radius = sqrt(fmax(0, 2 * b[3] + vec_dot(b, b)));
	for (int k = 0; k < 3; k++)
		h->center[k] = h->middle[k] + b[k];
	for (int i = 0; i < mesh->n_vertices; i++)
		if (loop[i] == which) {
			double d[3];
			for (int k = 0; k < 3; k++)
				d[k] = (double)mesh->vertices[i][k] - h->center[k];
			square += pow(vec_norm(d) - h->radius, 2) / n;
		}
	h->off = sqrt(square);
	return true;
}

/* Whether the hole can be that of an eye: as wide, on a sphere as large, whose centre lies behind it. */
static bool is_eye(const struct hole *h)
{
	return h->width > width_least && h->width < width_most && h->radius > radius_least && h->radius < radius_most && h->off < off_most
	       && h->center[2] < h->middle[2];
}

bool rim_eyeball(double center[3], double *radius, const struct mesh *mesh, bool left, const float *near)
{
	struct topology t;
	struct hole best = { 0 };
	double least = INFINITY;
	int found = 0;
	topology_make(&t, mesh);
	int *loop = loops(&t);
	for (int i = 0; i < t.n; i++) {
		struct hole h;
		if (loop[i] != i || !fit(&h, mesh, loop, i) || !is_eye(&h))
			continue;
		double d[3] = { 0 };
		for (int k = 0; k < 3 && near; k++)
			d[k] = h.middle[k] - (double)near[k];
		if (near ? vec_norm(d) > near_enough : (h.middle[0] > 0) != left)
			continue;
		found++;
		if (vec_norm(d) < least) {
			least = vec_norm(d);
			best = h;
		}
	}
	free(loop);
	topology_free(&t);
	if (!found || (!near && found > 1))
		return false;
	memcpy(center, best.center, sizeof best.center);
	*radius = best.radius;
	return true;
}
