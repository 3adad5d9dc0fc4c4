#include "register/nricp/mirror.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lapacke.h>

#include "base/mem.h"
#include "math/vec.h"

/* A match of a smaller weight counts as none. */
static const float nothing = 0.01f;

static void reflect(double out[3], const struct nricp_plane *p, const double x[3])
{
	vec_add(out, x, -2 * (vec_dot(p->normal, x) - p->at), p->normal);
}

/* Whether nine in ten of sampled vertices have one at their mirror images: a mole or a parting breaks no symmetry. */
static bool is_mirror(const struct nricp_plane *plane, const struct mesh *mesh, const struct kdtree *tree, double tolerance)
{
	enum { SAMPLES = 500 };
	int step = mesh->n_vertices > SAMPLES ? mesh->n_vertices / SAMPLES : 1, n = 0, all = 0;
	for (int i = 0; i < mesh->n_vertices; i += step, all++) {
		const double x[3] = { mesh->vertices[i][0], mesh->vertices[i][1], mesh->vertices[i][2] };
		double image[3];
		int at;
		float d2;
		reflect(image, plane, x);
		kdtree_find(tree, 1, (float[]){ (float)image[0], (float)image[1], (float)image[2] }, 1, &at, &d2);
		n += (double)d2 < tolerance * tolerance;
	}
	return n > 0.9 * all;
}

/* Moves a plane to the symmetry near it: sampled vertices are paired with the nearest to their mirror images; n is the principal axis of
 * the pairs' differences (one power iteration a round), and the plane goes through the pairs' middles. */
static void settle(struct nricp_plane *plane, const struct mesh *mesh, const struct kdtree *tree)
{
	enum { ROUNDS = 30, SAMPLES = 500 };
	int step = mesh->n_vertices > SAMPLES ? mesh->n_vertices / SAMPLES : 1;
	for (int round = 0; round < ROUNDS; round++) {
		double sum[3] = { 0 }, mid[3] = { 0 };
		int n = 0;
		for (int i = 0; i < mesh->n_vertices; i += step, n++) {
			const double x[3] = { mesh->vertices[i][0], mesh->vertices[i][1], mesh->vertices[i][2] };
			double image[3], d[3];
			int at;
			float d2;
			reflect(image, plane, x);
			kdtree_find(tree, 1, (float[]){ (float)image[0], (float)image[1], (float)image[2] }, 1, &at, &d2);
			for (int k = 0; k < 3; k++) {
				d[k] = x[k] - (double)mesh->vertices[at][k];
				mid[k] += 0.5 * (x[k] + (double)mesh->vertices[at][k]);
			}
			vec_add(sum, sum, vec_dot(d, plane->normal), d);
		}
		if (!(vec_norm(sum) > 0))
			return;
		vec_unit(plane->normal, sum);
		plane->at = vec_dot(mid, plane->normal) / n;
	}
}

/* The plane across the working frame's x axis, which the head's symmetry is about once it is aligned, moved to the symmetry near it. */
static bool find_across(struct nricp_plane *out, const struct mesh *mesh, const struct kdtree *tree, double tolerance)
{
	double lo = INFINITY, hi = -INFINITY;
	for (int i = 0; i < mesh->n_vertices; i++) {
		lo = fmin(lo, (double)mesh->vertices[i][0]);
		hi = fmax(hi, (double)mesh->vertices[i][0]);
	}
	*out = (struct nricp_plane){ .normal = { 1 }, .at = (lo + hi) / 2 };
	settle(out, mesh, tree);
	return is_mirror(out, mesh, tree, tolerance);
}

bool nricp_plane_find(struct nricp_plane *out, const struct mesh *mesh, const double from_own[4][4], double tolerance)
{
	struct kdtree *tree = kdtree_new(mesh->n_vertices, 3, mesh->vertices[0]);
	bool found = false;
	for (int axis = 0; axis < 3 && !found; axis++) {
		double n[3] = { from_own[0][axis], from_own[1][axis], from_own[2][axis] }, len = vec_norm(n);
		double origin[3] = { from_own[0][3], from_own[1][3], from_own[2][3] }, lo = INFINITY, hi = -INFINITY;
		for (int k = 0; k < 3; k++)
			out->normal[k] = n[k] / len;
		for (int i = 0; i < mesh->n_vertices; i++) {
			double x = 0;
			for (int k = 0; k < 3; k++)
				x += out->normal[k] * (double)mesh->vertices[i][k];
			lo = fmin(lo, x);
			hi = fmax(hi, x);
		}
		for (int which = 0; which < 2 && !found; which++) {
			out->at = which ? (lo + hi) / 2 : vec_dot(out->normal, origin);
			found = is_mirror(out, mesh, tree, tolerance);
		}
	}
	found = found || find_across(out, mesh, tree, tolerance);
	kdtree_free(tree);
	return found;
}

void nricp_twins_make(struct nricp_twins *out, const struct nricp_graph *g, const struct nricp_plane *plane)
{
	size_t n = (size_t)g->n + 1;
	float (*place)[3] = mem_array(n, sizeof *place);
	*out = (struct nricp_twins){ .plane = *plane };
	out->node = mem_array(n, sizeof *out->node);
	out->off = mem_array(n, sizeof *out->off);
	for (int i = 0; i < g->n; i++)
		for (int k = 0; k < 3; k++)
			place[i][k] = (float)g->place[i][k];
	struct kdtree *tree = kdtree_new(g->n, 3, place[0]);
	for (int i = 0; i < g->n; i++) {
		double image[3];
		int at;
		float d2;
		reflect(image, plane, g->place[i]);
		kdtree_find(tree, 1, (float[]){ (float)image[0], (float)image[1], (float)image[2] }, 1, &at, &d2);
		out->node[i] = at;
		for (int k = 0; k < 3; k++)
			out->off[i][k] = image[k] - g->place[at][k];
	}
	kdtree_free(tree);
	free(place);
}

void nricp_twins_free(struct nricp_twins *t)
{
	free(t->node);
	free(t->off);
	*t = (struct nricp_twins){ 0 };
}

/* Where the registration has moved the mirror image of node i. */
static void place_of_image(double out[3], const struct nricp_twins *t, int i, const struct nricp_point *points, const double (*affine)[3][3])
{
	int twin = t->node[i];
	mat_vec(out, affine[twin], t->off[i]);
	for (int k = 0; k < 3; k++)
		out[k] += (double)points[twin].at[k];
}

/* The plane about which the moved nodes are most nearly symmetric, from those matched on both sides: its normal n minimises
 * sum w (n'a)(n'b), an eigenvalue problem, with a and b from the centroid to a node and to its moved mirror image. False: less than a
 * tenth of the area is matched on both sides. */
static bool fit_plane(struct nricp_plane *out, const struct nricp_twins *t, const struct nricp_graph *g, const struct nricp_point *points,
                      const struct nricp_match *match, const double (*affine)[3][3])
{
	double m[3][3] = { 0 }, sum = 0, mid[3] = { 0 }, all = 0, values[3];
	for (int pass = 0; pass < 2; pass++) {
		for (int i = 0; i < g->n; i++) {
			double w = g->area[i] * (double)(match[i].weight * match[t->node[i]].weight), b[3];
			all += g->area[i];
			if (!(w > 0))
				continue;
			place_of_image(b, t, i, points, affine);
			for (int r = 0; r < 3; r++)
				if (!pass)
					mid[r] += w * ((double)points[i].at[r] + b[r]) / 2;
				else
					for (int c = 0; c < 3; c++)
						m[r][c] += w * (((double)points[i].at[r] - mid[r]) * (b[c] - mid[c])
						                + ((double)points[i].at[c] - mid[c]) * (b[r] - mid[r])) / 2;
			sum += w;
		}
		for (int r = 0; r < 3 && !pass && sum > 0; r++)
			mid[r] /= sum;
	}
	if (!(sum > 0.1 * all) || LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 3, &m[0][0], 3, values))
		return false;
	for (int k = 0; k < 3; k++)
		out->normal[k] = m[k][0];
	out->at = vec_dot(out->normal, mid);
	return values[0] < 0;
}

void nricp_twins_ask(struct nricp_pulls *data, const struct nricp_twins *t, const struct nricp_graph *g, const struct nricp_point *points,
                     const struct nricp_match *match, const double (*affine)[3][3], double weight)
{
	struct nricp_plane plane;
	if (!fit_plane(&plane, t, g, points, match, affine))
		return;
	for (int i = 0; i < g->n; i++) {
		double w = g->area[i] * weight * (double)match[t->node[i]].weight, b[3];
		if (match[i].weight > nothing || !(match[t->node[i]].weight > nothing) || match[i].on_rim)
			continue;
		place_of_image(b, t, i, points, affine);
		reflect(data->goal[i], &plane, b);
		memcpy(data->k[i], (double[]){ w, 0, 0, w, 0, w }, sizeof *data->k);
	}
}
