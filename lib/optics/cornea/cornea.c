#include "optics/cornea/cornea.h"

#include <float.h>
#include <math.h>

#include "math/vec.h"

/* A quadric of revolution x² + y² − 2R(z − apex) + p(z − apex)² = 0. */
struct quadric {
	double R, p, apex;
};

double cornea_depth(const struct cornea *cornea, double r)
{
	double R2 = cornea->R * cornea->R, s2 = R2 - cornea->p * r * r;
	// rounding may put a point of the equator outside
	return s2 < -8 * DBL_EPSILON * R2 ? NAN : r * r / (cornea->R + sqrt(fmax(s2, 0)));
}

double cornea_edge(const struct cornea *cornea)
{
	return cornea->p > 0 ? fmin(cornea->rim, cornea->R / sqrt(cornea->p)) : cornea->rim;
}

static void quadric_normal(double normal[3], const struct quadric *q, const double K[3])
{
	double g[3] = { K[0], K[1], q->p * (K[2] - q->apex) - q->R };
	vec_unit(normal, g);
}

void cornea_normal(double normal[3], const struct cornea *cornea, const double K[3])
{
	quadric_normal(normal, &(struct quadric){ cornea->R, cornea->p, 0 }, K);
}

/* First crossing into the quadric's inside, on its front half. dir is unit. */
static bool quadric_enter(double K[3], const struct quadric *q, const double origin[3], const double dir[3])
{
	// Starts from the point of the ray nearest to the apex, so that a camera 10 km away costs no digits.
	double o[3] = { origin[0], origin[1], origin[2] - q->apex }, near = fmin(0, vec_dot(o, dir));
	vec_add(o, o, -near, dir);
	double A = dir[0] * dir[0] + dir[1] * dir[1] + q->p * dir[2] * dir[2];
	double B = o[0] * dir[0] + o[1] * dir[1] + (q->p * o[2] - q->R) * dir[2];
	double C = o[0] * o[0] + o[1] * o[1] + o[2] * (q->p * o[2] - 2 * q->R), disc = B * B - A * C;
	if (!(disc >= 0))
		return false;
	// The root where the ray enters, in the form that loses no digits (A = 0: a paraboloid along its axis).
	double t = B < 0 ? C / (sqrt(disc) - B) : -(B + sqrt(disc)) / A;
	if (!(t - near > 0) || !isfinite(t))
		return false;
	vec_add(K, o, t, dir);
	bool front = q->p * K[2] <= q->R;
	K[2] += q->apex;
	return front;
}

bool cornea_hit(double K[3], const struct cornea *cornea, const double origin[3], const double dir[3])
{
	double unit[3];
	vec_unit(unit, dir);
	return quadric_enter(K, &(struct quadric){ cornea->R, cornea->p, 0 }, origin, unit)
	       && hypot(K[0], K[1]) <= cornea->rim;
}

bool refract(double out[3], const double dir[3], const double N[3], double n1, double n2)
{
	double eta = n1 / n2, c = -vec_dot(dir, N), k = 1 - eta * eta * (1 - c * c);
	if (!(k >= 0))
		return false;
	for (int i = 0; i < 3; i++)
		out[i] = eta * dir[i] + (eta * c - sqrt(k)) * N[i];
	return true;
}

bool cornea_sight(double K[3], double from[3], double inside[3], const struct cornea *cornea,
                  const double origin[3], const double dir[3])
{
	double unit[3], N[3];
	vec_unit(unit, dir);
	if (!cornea_hit(K, cornea, origin, unit))
		return false;
	cornea_normal(N, cornea, K);
	if (!refract(inside, unit, N, 1, cornea->two_surface ? cornea->n_cornea : cornea->n))
		return false;
	if (!cornea->two_surface) {
		for (int i = 0; i < 3; i++)
			from[i] = K[i];
		return true;
	}
	struct quadric back = { cornea->R_post, cornea->p_post, cornea->thickness };
	double within[3] = { inside[0], inside[1], inside[2] };
	if (!quadric_enter(from, &back, K, within))
		return false;
	quadric_normal(N, &back, from);
	return refract(inside, within, N, cornea->n_cornea, cornea->n);
}
