#include <math.h>

#include "math/vec.h"
#include "optics/lightpath.h"
#include "optics/lightpath_path.h"

enum { RINGS = 9, SPOKES = 24 };

static double cos_incidence(const struct path *path, const double K[3])
{
	double u[3], N[3];
	path_outward(u, path, K);
	cornea_normal(N, path->cornea, K);
	return vec_dot(u, N);
}

/* Newton's steps towards any stationary point, minimum or not. */
static bool settle(struct chart *at, const struct path *path)
{
	for (int i = 0; i < 30; i++) {
		double g[2], H[3], step[2];
		path_derivatives(g, H, path, at);
		double det = H[0] * H[2] - H[1] * H[1];
		step[0] = (H[1] * g[1] - H[2] * g[0]) / det;
		step[1] = (H[1] * g[0] - H[0] * g[1]) / det;
		double size = hypot(step[0], step[1]), longest = 0.7;
		if (!isfinite(size))
			return false;
		for (int k = 0; k < 2 && size > longest; k++)
			step[k] *= longest / size;
		*at = chart_moved(path->cornea, at, step);
		if (size < 1e-9)
			return true;
		if (at->rho2 > 4)
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

int path_search(double K[][3], int max, const struct path *path)
{
	const struct cornea *c = path->cornea;
	double edge = cornea_edge(c);
	int n = 0;
	for (int ring = 0; ring < RINGS; ring++) {
		for (int spoke = 0; spoke < SPOKES; spoke++) {
			double r = edge * (ring + 0.5) / RINGS, phi = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / SPOKES;
			double start[3] = { r * cos(phi), r * sin(phi), cornea_depth(c, r) };
			if (cos_incidence(path, start) < -0.02)
				continue;
			struct chart at = chart_of(c, start);
			if (!settle(&at, path) || cos_incidence(path, at.K) < 0)
				continue;
			path_polish(&at, path);
			if (hypot(at.K[0], at.K[1]) <= c->rim && c->p * at.K[2] <= c->R)
				n = add(K, n, max, path, at.K);
		}
	}
	return n;
}

int lightpath_all(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                  const double w[3])
{
	struct path path = { cornea, P, C, C ? 0 : w };
	return path_is_sound(&path) ? path_search(K, max, &path) : 0;
}
