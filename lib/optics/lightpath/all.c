#include "optics/lightpath/all.h"

#include <math.h>

#include "base/mem.h"
#include "math/vec.h"

/* Branch and bound: all paths are the zeros of the miss (path_miss) over the lit cornea. The cornea is divided into squares of
 * the chart. A square is discarded when no zero can be in it, solved by Newton's method when it has one at most, and divided in
 * four otherwise. Both tests use the miss and its Jacobian at the centre and a bound on how much the Jacobian changes up to the
 * corners, so that no path is overlooked, however thin the sliver of the cornea that it goes through and however close it is to
 * another. */

/* Least half side of a square, relative to the radius of the edge: two paths closer than that have met in a focus. At most
 * SQUARES_MAX are examined: there are more only where a whole ring of paths meets in P. */
static const double SMALLEST = 1e-8;
enum { SQUARES_MAX = 20000, LEVELS_MAX = 32 };

struct square {
	double x, y, half;  // in the chart
};

/* Constants of the surface that bound the change of the Jacobian. */
struct bound {
	double rho;      // radius of the edge in the chart
	double kappa;    // largest curvature of the surface, 1/mm
	double stretch;  // length of the chart's longest tangent
	double bend;     // change of the curvature along the surface, over kappa²
};

static struct bound bound_of(const struct cornea *c)
{
	double edge = cornea_edge(c), R = c->R, p = c->p, g = sqrt(fmax(R * R + (1 - p) * edge * edge, 0));
	double rho = edge / (2 * R - p * cornea_depth(c, edge)), tau = 2 / (1 + p * rho * rho);
	return (struct bound){ .rho = rho * (1 + 1e-12), .kappa = fmax(fmax(1 / R, 1 / g), R * R / (g * g * g)),
		               .stretch = sqrt(fmax(1, 1 + rho * rho * tau * (tau * (1 + p * p * rho * rho) - 2 * p))),
		               .bend = 3 * fabs(1 - p) };
}

static double cos_incidence(double *light, const struct path *path, const double K[3])
{
	double u[3], N[3];
	*light = path_outward(u, path, K);
	cornea_normal(N, path->cornea, K);
	return vec_dot(u, N);
}

/* Derivative of the refracted direction as the surface turns: s' = κ (1 − bend); returns bend. */
static double law(double cos_i, double n)
{
	return cos_i / sqrt(n * n - 1 + cos_i * cos_i + 1e-300);
}

/* Bounds on the change of the Jacobian within `radius` mm of K: *most, and *least, in which the part that grows evenly counts
 * half. With s the unit direction inside, τ its length to P, o = 1 / distance of the light, k = κ + o: |s'| <= k, and s'' is k²
 * and what Snell's law adds, suddenly at grazing incidence for n near 1. Returns false when no point within the radius is lit. */
static bool change(double *least, double *most, const struct path *path, const struct bound *b, const double K[3], double radius)
{
	double v[3], n = path->cornea->n, light, cos_i = cos_incidence(&light, path, K);
	double o = light > 0 ? light / fmax(1 - light * radius, 1e-3) : 0, k = b->kappa + o, reach = k * radius;
	if (cos_i + reach < 0)
		return false;
	vec_add(v, K, -1, path->P);
	double tau = vec_norm(v) + radius, at = law(cos_i, n), low = law(fmax(cos_i - reach, fmin(cos_i, 0)), n);
	double high = law(fmin(cos_i + reach, 1), n), square = b->stretch * b->stretch;
	double even = square * radius * (b->kappa + 2 * k + tau * (k * k + b->bend * b->kappa * b->kappa + o * o));
	double sudden = square * tau * k * fmax(at - low, high - at);
	*least = 0.5 * even + sudden;
	*most = even + sudden;
	return true;
}

enum verdict { NONE, AT_MOST_ONE, MANY };

/* Computes the singular values of J and the components of the miss along its left singular vectors. */
static void across(double sigma[2], double along[2], const double J[2][2], const double miss[2])
{
	double A = J[0][0] * J[0][0] + J[0][1] * J[0][1], C = J[1][0] * J[1][0] + J[1][1] * J[1][1];
	double B = J[0][0] * J[1][0] + J[0][1] * J[1][1], diff = 0.5 * (A - C), root = sqrt(diff * diff + B * B);
	double e[2] = { diff >= 0 ? diff + root : B, diff >= 0 ? B : root - diff }, length = hypot(e[0], e[1]);
	e[0] = length > 0 ? e[0] / length : 1;
	e[1] = length > 0 ? e[1] / length : 0;
	sigma[0] = sqrt(0.5 * (A + C) + root);
	sigma[1] = sigma[0] > 0 ? fabs(J[0][0] * J[1][1] - J[0][1] * J[1][0]) / sigma[0] : 0;
	along[0] = fabs(e[0] * miss[0] + e[1] * miss[1]);
	along[1] = fabs(e[0] * miss[1] - e[1] * miss[0]);
}

static enum verdict look(struct chart *at, double *radius, const struct path *path, const struct bound *b, const struct square *s)
{
	double miss[2], J[2][2], sigma[2], along[2], least, most;
	if (hypot(s->x, s->y) - M_SQRT2 * s->half > b->rho)
		return NONE;
	*at = chart_at(path->cornea, s->x, s->y);
	*radius = M_SQRT2 * s->half * path->cornea->R * at->tau;
	if (!change(&least, &most, path, b, at->K, *radius * b->stretch))
		return NONE;
	path_miss(miss, J, path, at);
	across(sigma, along, J, miss);
	for (int i = 0; i < 2; i++)
		if (along[i] > (sigma[i] + least) * *radius)
			return NONE;
	return most < 0.5 * sigma[1] ? AT_MOST_ONE : MANY;
}

/* Newton's method to the zero of the miss, steps at most `longest` mm. Returns false when it does not converge. */
static bool settle(struct chart *at, const struct path *path, double longest)
{
	for (int i = 0; i < 30; i++) {
		double r[2], J[2][2], step[2];
		path_miss(r, J, path, at);
		double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
		step[0] = (J[0][1] * r[1] - J[1][1] * r[0]) / det;
		step[1] = (J[1][0] * r[0] - J[0][0] * r[1]) / det;
		double size = hypot(step[0], step[1]);
		if (!isfinite(size))
			return false;
		for (int k = 0; k < 2 && size > longest; k++)
			step[k] *= longest / size;
		*at = chart_moved(path->cornea, at, step);
		if (size < 1e-9)
			return true;
	}
	return false;
}

/* Inserts k into the list K[n] in the order of optical length, unless it is there already. Returns the new number. */
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

/* Runs Newton's method from the centre of a square and adds what it converges to, if that is a path. Returns false when it does not
 * converge. */
static bool polish(double K[][3], int *n, int max, const struct path *path, struct chart at, double radius)
{
	const struct cornea *c = path->cornea;
	double light;
	if (!settle(&at, path, 2 * radius))
		return false;
	path_polish(&at, path);
	bool inside = at.K[0] * at.K[0] + at.K[1] * at.K[1] <= c->rim * c->rim && c->p * at.K[2] <= c->R;
	if (inside && cos_incidence(&light, path, at.K) >= 0)
		*n = add(K, *n, max, path, at.K);
	return true;
}

int path_search(double K[][3], int max, const struct path *path)
{
	struct bound bound = bound_of(path->cornea);
	struct square todo[4 * LEVELS_MAX] = { { 0, 0, bound.rho } };
	int n = 0, left = bound.rho > 0 && isfinite(bound.rho);
	for (int looked = 0; left && looked < SQUARES_MAX && left + 4 <= COUNT(todo); looked++) {
		struct square s = todo[--left];
		struct chart at;
		double radius, half = 0.5 * s.half;
		enum verdict verdict = look(&at, &radius, path, &bound, &s);
		bool smallest = s.half < SMALLEST * bound.rho;
		if (verdict == NONE || ((verdict == AT_MOST_ONE || smallest) && (polish(K, &n, max, path, at, radius) || smallest)))
			continue;
		for (int k = 0; k < 4; k++)
			todo[left++] = (struct square){ s.x + (k & 1 ? half : -half), s.y + (k & 2 ? half : -half), half };
	}
	return n;
}

static double clear_depth(const struct cornea *cornea)
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

double lightpath_clear_depth(const struct cornea *cornea)
{
	// Cached: it is needed again and again for one cornea, and costs as much as a whole path.
	static _Thread_local struct {
		double R, p, n, rim, depth;
	} last;
	if (cornea->R != last.R || cornea->p != last.p || cornea->n != last.n || cornea->rim != last.rim) {
		last.depth = clear_depth(cornea);
		last.R = cornea->R, last.p = cornea->p, last.n = cornea->n, last.rim = cornea->rim;
	}
	return last.depth;
}

int lightpath_all(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                  const double w[3])
{
	struct path path = { cornea, P, C, C ? 0 : w };
	return path_is_sound(&path) ? path_search(K, max, &path) : 0;
}
