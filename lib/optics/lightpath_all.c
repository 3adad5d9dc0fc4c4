#include <math.h>

#include "math/vec.h"
#include "optics/lightpath.h"
#include "optics/lightpath_path.h"

/* Starts of a search: a grid over the lit cornea, and how long a first step may be, over the edge's radius. */
struct grid {
	int rings, spokes;
	double first;
};
static const struct grid quick = { 8, 20, 0.3 }, thorough = { 12, 40, 2 }, sliver = { 24, 80, 2 }, finest = { 60, 200, 2 };

/* The grid that misses no path. Light from the side or from behind reaches a sliver of the cornea along its edge; a P
 * outside the limbus sees through a still narrower one. */
static const struct grid *grid_for_all(const struct path *path)
{
	double u[3];
	path_outward(u, path, path->P);
	if (path->P[0] * path->P[0] + path->P[1] * path->P[1] > path->cornea->rim * path->cornea->rim)
		return &finest;
	return u[2] > -0.6 ? &sliver : &thorough;
}

static double cos_incidence(const struct path *path, const double K[3])
{
	double u[3], N[3];
	path_outward(u, path, K);
	cornea_normal(N, path->cornea, K);
	return vec_dot(u, N);
}

/* One Newton step towards a stationary point of any kind; its length, mm. */
static double step_to(double step[2], const struct path *path, const struct chart *at)
{
	double g[2], H[3];
	path_derivatives(g, H, path, at);
	double det = H[0] * H[2] - H[1] * H[1];
	step[0] = (H[1] * g[1] - H[2] * g[0]) / det;
	step[1] = (H[1] * g[0] - H[0] * g[1]) / det;
	return sqrt(step[0] * step[0] + step[1] * step[1]);
}

/* Newton's steps from a start of the grid. False when they leave the lit cornea, or begin with a step that leads out
 * of the start's surroundings: another start is nearer then. */
static bool settle(struct chart *at, const struct path *path, double edge, double first)
{
	for (int i = 0; i < 20; i++) {
		double step[2], size = step_to(step, path, at), longest = 0.1 * edge;
		if (!(size < (i ? 1e3 : first) * edge))
			return false;
		for (int k = 0; k < 2 && size > longest; k++)
			step[k] *= longest / size;
		*at = chart_moved(path->cornea, at, step);
		if (size < 1e-9)
			return true;
		if (at->K[0] * at->K[0] + at->K[1] * at->K[1] > 1.3 * edge * edge || cos_incidence(path, at->K) < -0.2)
			return false;
	}
	return false;
}

/* Adds K, in the order of optical length, unless it is there. */
static int add(double K[][3], int n, int max, const struct path *path, const double k[3])
{
	int place = 0;
	for (int i = 0; i < n; i++) {
		double gap[3];
		vec_add(gap, k, -1, K[i]);
		if (vec_norm(gap) < 1e-7)
			return n;
		place += path_length_change(path, k, K[i]) < 0;
	}
	if (place >= max)
		return n;
	int last = n < max ? n : max - 1;
	for (int i = last; i > place; i--)
		for (int j = 0; j < 3; j++)
			K[i][j] = K[i - 1][j];
	for (int j = 0; j < 3; j++)
		K[place][j] = k[j];
	return last + 1;
}

/* From one start to a path that counts. */
static int try(double K[][3], int n, int max, const struct path *path, struct chart at, double edge, double first)
{
	const struct cornea *c = path->cornea;
	if (!settle(&at, path, edge, first) || cos_incidence(path, at.K) < 0)
		return n;
	path_polish(&at, path);
	bool inside = at.K[0] * at.K[0] + at.K[1] * at.K[1] <= c->rim * c->rim && c->p * at.K[2] <= c->R;
	return inside ? add(K, n, max, path, at.K) : n;
}

static int search(double K[][3], int max, const struct path *path, const struct grid *grid)
{
	const struct cornea *c = path->cornea;
	double edge = cornea_edge(c), u[3];
	int n = 0;
	// Above P, where it lies close to the surface: a grid would need to be fine there.
	path_outward(u, path, path->P);
	for (int i = 0; i <= 4; i++)
		n = try(K, n, max, path, path_leave(path, (double[]){ u[0], u[1], u[2] - 0.5 * i }), edge, 1);
	for (int ring = 0; ring < grid->rings; ring++) {
		for (int spoke = 0; spoke < grid->spokes; spoke++) {
			double r = edge * (ring + 1) / grid->rings, phi = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / grid->spokes;
			double start[3] = { r * cos(phi), r * sin(phi), cornea_depth(c, r) };
			if (cos_incidence(path, start) > -0.02)
				n = try(K, n, max, path, chart_of(c, start), edge, grid->first);
		}
	}
	return n;
}

int path_search(double K[][3], int max, const struct path *path)
{
	int n = search(K, max, path, &quick);
	return n ? n : search(K, max, path, grid_for_all(path));
}

double lightpath_clear_depth(const struct cornea *cornea)
{
	double least = INFINITY, R = cornea->R, p = cornea->p, n = cornea->n;
	for (int i = 0; i <= 32; i++) {
		// Light across the axis; K in the plane of both; the nearer of its two foci, where that plane's rays cross.
		double x = cornea_edge(cornea) * i / 32, z = cornea_depth(cornea, x), g = sqrt(R * R + (1 - p) * x * x);
		double cos_i = x / g, cos_t = sqrt(1 - (1 - cos_i * cos_i) / (n * n)), power = (n * cos_t - cos_i) * R * R / (g * g * g);
		double down = (n * cos_t - cos_i) * (R - p * z) / (g * n);
		least = fmin(least, z + n * cos_t * cos_t / power * down);
	}
	return 0.97 * least;
}

int lightpath_all(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                  const double w[3])
{
	struct path path = { cornea, P, C, C ? 0 : w };
	return path_is_sound(&path) ? search(K, max, &path, grid_for_all(&path)) : 0;
}
