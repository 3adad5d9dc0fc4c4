#include "tests/peers/sclera_photons.h"

#include <math.h>
#include <stdbool.h>

#include "math/rng.h"
#include "math/vec.h"
#include "tests/peers/fresnel.h"

struct photon {
	double at[3], way[3], weight;
};

/* Of a parallel beam from +z, one that has come through the surface. */
static void enter(struct photon *p, struct rng *rng, const struct sclera_shell *s)
{
	double r = s->radius * sqrt(rng_uniform(rng)), turn = 2 * M_PI * rng_uniform(rng), up = sqrt(fmax(s->radius * s->radius - r * r, 0));
	double c = up / s->radius, bent = sqrt(1 - (1 - c * c) / (s->index * s->index));
	*p = (struct photon){ { r * cos(turn), r * sin(turn), up }, { 0, 0, -1 / s->index }, fresnel_transmittance(c, 1, s->index) };
	vec_add(p->way, p->way, (c / s->index - bent) / s->radius, p->at);
}

/* A new way, by Henyey and Greenstein. */
static void scatter(double way[3], struct rng *rng, double g)
{
	double x = (1 - g * g) / (1 - g + 2 * g * rng_uniform(rng)), c = (1 + g * g - x * x) / (2 * g), s = sqrt(fmax(1 - c * c, 0)), turn = 2 * M_PI * rng_uniform(rng);
	double side[3], other[3], axis[3] = { fabs(way[0]) < 0.6, fabs(way[0]) >= 0.6, 0 };
	vec_cross(side, way, axis);
	vec_unit(side, side);
	vec_cross(other, way, side);
	for (int i = 0; i < 3; i++)
		way[i] = c * way[i] + s * (cos(turn) * side[i] + sin(turn) * other[i]);
	vec_unit(way, way);
}

/* How far it is along the way to the sphere of that radius, from inside or (to its near side) from outside; infinite: it is missed. */
static double far(const struct photon *p, double radius, bool inside)
{
	double b = vec_dot(p->at, p->way), disc = b * b - vec_dot(p->at, p->at) + radius * radius;
	return inside ? -b + sqrt(fmax(disc, 0)) : disc > 0 && b < 0 ? -b - sqrt(disc) : INFINITY;
}

/* Follows one until it leaves (true), or is lost in the dark or absorbed. */
static bool leaves(struct photon *p, struct rng *rng, const struct sclera_shell *s)
{
	const double per_mm = s->scatter / (1 - s->anisotropy);
	for (;;) {
		double step = -log(1 - rng_uniform(rng)) / per_mm, out = far(p, s->radius, true), in = far(p, s->radius - s->thickness, false), go = fmin(step, fmin(out, in));
		vec_add(p->at, p->at, go, p->way);
		p->weight *= exp(-s->absorb * go);
		if (go == in)
			return false;
		if (go == step) {
			scatter(p->way, rng, s->anisotropy);
			if (p->weight < 1e-3 && rng_uniform(rng) < 0.9)
				return false;
			p->weight *= p->weight < 1e-3 ? 10 : 1;
			continue;
		}
		double normal[3], c;
		vec_unit(normal, p->at);
		c = vec_dot(p->way, normal);
		if (rng_uniform(rng) < fresnel_transmittance(c, s->index, 1))
			return true;
		vec_add(p->way, p->way, -2 * c, normal);
		for (int i = 0; i < 3; i++)
			p->at[i] = (s->radius - 1e-9) * normal[i];
	}
}

double sclera_photons(double out[], int n, const struct sclera_shell *shell, long photons, uint64_t seed)
{
	struct rng rng = { seed };
	double all = 0;
	for (int k = 0; k < n; k++)
		out[k] = 0;
	for (long i = 0; i < photons; i++) {
		struct photon p;
		enter(&p, &rng, shell);
		if (!leaves(&p, &rng, shell))
			continue;
		int k = (int)(acos(fmin(fmax(p.at[2] / shell->radius, -1), 1)) / M_PI * n);
		out[k < n ? k : n - 1] += p.weight;
		all += p.weight;
	}
	for (int k = 0; k < n; k++)
		out[k] /= all * 0.5 * (cos(M_PI * k / n) - cos(M_PI * (k + 1) / n));
	return all / (double)photons;
}
