#include "optics/lightpath/lightpath.h"

#include <math.h>
#include <stdbool.h>

#include "math/vec.h"
#include "optics/lightpath/all.h"
#include "optics/lightpath/path.h"

/* Newton's step; where L is not convex its Hessian is shifted so that the step descends. Returns the least curvature of L, 1/mm. */
static double newton_step(double step[2], const double g[2], const double H[3])
{
	double mean = 0.5 * (H[0] + H[2]), diff = 0.5 * (H[0] - H[2]), half = sqrt(diff * diff + H[1] * H[1]), least = mean - half;
	double lift = least < 1e-12 * half ? 1e-2 * (fabs(mean) + half) - least : 0;
	double a = H[0] + lift, c = H[2] + lift, det = a * c - H[1] * H[1];
	step[0] = (H[1] * g[1] - c * g[0]) / det;
	step[1] = (H[1] * g[0] - a * g[1]) / det;
	return least;
}

/* Closed-form start: leaves P along the direction to the light, bent towards the axis; refracts the light there, and leaves P
 * along that direction. */
static struct chart first_guess(const struct path *path)
{
	double u[3], q[3];
	path_outward(u, path, path->P);
	struct chart at = path_leave(path, (double[]){ u[0], u[1], u[2] - path_bend(path->cornea->n) });
	path_outward(u, path, at.K);
	path_inside(q, path, &at, u);
	return path_leave(path, q);
}

/* Newton's method with backtracking. Returns false where it does not converge to a minimum: at a focus, where L is flat. *least:
 * curvature of L at the end. */
static bool descend(struct chart *at, double *least, const struct path *path)
{
	for (int i = 0; i < 60; i++) {
		double g[2], H[3], step[2];
		path_derivatives(g, H, path, at);
		*least = newton_step(step, g, H);
		double size = sqrt(step[0] * step[0] + step[1] * step[1]), slope = step[0] * g[0] + step[1] * g[1], k = 1;
		if (!isfinite(size))
			return false;
		if (size > 3)
			k = 3 / size;
		struct chart next = chart_moved(path->cornea, at, (double[]){ k * step[0], k * step[1] });
		// Below 1e-7 mm L does not resolve the difference; Newton's step is right there.
		while (size > 1e-7 && k > 1e-6 && !(path_length_change(path, at->K, next.K) <= 1e-4 * k * slope)) {
			k *= 0.4;
			next = chart_moved(path->cornea, at, (double[]){ k * step[0], k * step[1] });
		}
		*at = next;
		if (size < 1e-9)
			return true;
	}
	return false;
}

static enum lightpath_status judge(const double K[3], const struct path *path)
{
	double u[3], N[3];
	path_outward(u, path, K);
	cornea_normal(N, path->cornea, K);
	if (vec_dot(u, N) < 0)
		return LIGHTPATH_GRAZING;
	return hypot(K[0], K[1]) > path->cornea->rim || N[2] > 0 ? LIGHTPATH_BEYOND_RIM : LIGHTPATH_OK;
}

enum lightpath_status path_shortest(double K[3], const struct path *path)
{
	double least;
	for (int i = 0; i < 3; i++)
		K[i] = 0;
	if (!path_is_sound(path))
		return LIGHTPATH_NONE;
	struct chart at = first_guess(path);
	bool found = descend(&at, &least, path);
	if (!isfinite(at.K[0] + at.K[1] + at.K[2]))
		return LIGHTPATH_NONE;
	if (found && least < 0.3)
		path_polish(&at, path);
	for (int i = 0; i < 3; i++)
		K[i] = at.K[i];
	return found ? judge(K, path) : LIGHTPATH_NONE;
}

/* Whether there may be a physical path although the shortest one is none: another minimum, or a stationary point that is no
 * minimum, as occurs where the light has passed a focus. With the shortest path beyond the rim that takes light from the side:
 * none was found at less than 60 degrees (distant light). */
static bool may_hide(enum lightpath_status shortest, const struct path *path)
{
	if (shortest == LIGHTPATH_OK || !path_is_sound(path))
		return false;
	if (shortest == LIGHTPATH_NONE || (path->C && vec_norm(path->C) < 100))
		return true;
	double u[3];
	path_outward(u, path, path->P);
	if (u[2] < 0 && path->P[2] < lightpath_clear_depth(path->cornea))
		return false;
	return shortest == LIGHTPATH_GRAZING || u[2] > -0.7;
}

static enum lightpath_status solve(double K[3], const struct path *path)
{
	double found[1][3];
	enum lightpath_status status = path_shortest(K, path);
	if (!may_hide(status, path) || !path_search(found, 1, path))
		return status;
	for (int i = 0; i < 3; i++)
		K[i] = found[0][i];
	return LIGHTPATH_OK;
}

enum lightpath_status lightpath_solve(double K[3], const struct cornea *cornea, const double P[3], const double C[3])
{
	return solve(K, &(struct path){ cornea, P, C, 0 });
}

enum lightpath_status lightpath_solve_directional(double K[3], const struct cornea *cornea, const double P[3],
                                                  const double w[3])
{
	return solve(K, &(struct path){ cornea, P, 0, w });
}
