#include <math.h>

#include "math/simd.h"
#include "optics/cornea/cornea.h"

/* Rays are traced in double, stored in float: float arithmetic errs by 1e-5 mm and more where a ray grazes. */
struct ray {
	double o[3], d[3];
};

struct quadric {
	double R, p, apex;
};

/* Moves the ray's origin to where it enters the quadric and refracts it by Snell's law with index ratio m = n2/n1 (m2_1 = m² −
 * 1). The direction's length is multiplied by m. With G = (x, y, pz − R) at the entry, d·G is minus the root of
 * the intersection's discriminant, and |G|² = R² + (1 − p) z (2R − pz): neither needs another root. */
SIMD_INLINE bool enter(struct ray *ray, struct quadric q, double m2_1)
{
	double x = ray->o[0], y = ray->o[1], z = ray->o[2] - q.apex, dx = ray->d[0], dy = ray->d[1], dz = ray->d[2];
	double A = dx * dx + dy * dy + q.p * dz * dz, B = x * dx + y * dy + (q.p * z - q.R) * dz;
	double C = x * x + y * y + z * (q.p * z - 2 * q.R), disc = B * B - A * C;
	double root = sqrt(disc > 0 ? disc : 0), t = C / (root - B);
	x += t * dx;
	y += t * dy;
	z += t * dz;
	double g2 = q.R * q.R + (1 - q.p) * z * (2 * q.R - q.p * z), d2 = dx * dx + dy * dy + dz * dz;
	double f = (root - sqrt(disc + m2_1 * g2 * d2)) / g2;
	ray->o[0] = x;
	ray->o[1] = y;
	ray->o[2] = z + q.apex;
	ray->d[0] = dx + f * x;
	ray->d[1] = dy + f * y;
	ray->d[2] = dz + f * (q.p * z - q.R);
	return (disc >= 0) & (B < 0) & (t > 0) & (q.p * z <= q.R);
}

/* What all rays share. */
struct sight {
	struct quadric front, back;
	double m2_front, m2_back, n, rim2, origin[3], ahead;
};

static struct sight sight_of(const struct cornea *c, const double o[3])
{
	double edge = cornea_edge(c), n1 = c->two_surface ? c->n_cornea : c->n, m = c->n / n1;
	// The rays are started a little before the eye instead of kilometres away, so that their discriminants keep their digits.
	double ahead = fmax(0, sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]) - 16);
	return (struct sight){ { c->R, c->p, 0 }, { c->R_post, c->p_post, c->thickness }, n1 * n1 - 1, m * m - 1, c->n,
		               edge * edge, { o[0], o[1], o[2] }, ahead };
}

SIMD_INLINE bool see(struct ray *ray, double K[3], const struct sight *s, bool two, double dx, double dy, double dz)
{
	*ray = (struct ray){ { s->origin[0] + s->ahead * dx, s->origin[1] + s->ahead * dy, s->origin[2] + s->ahead * dz },
		             { dx, dy, dz } };
	bool hit = enter(ray, s->front, s->m2_front);
	for (int k = 0; k < 3; k++)
		K[k] = ray->o[k];
	hit &= K[0] * K[0] + K[1] * K[1] <= s->rim2;
	if (two)
		hit &= enter(ray, s->back, s->m2_back);
	return hit;
}

SIMD_INLINE void plane_lane(int i, const float *dx, const float *dy, const float *dz, float *qx, float *qy, double depth,
                            const struct sight *s, bool two)
{
	struct ray ray;
	double K[3];
	bool hit = see(&ray, K, s, two, dx[i], dy[i], dz[i]);
	double t = (depth - ray.o[2]) / ray.d[2], x = ray.o[0] + t * ray.d[0], y = ray.o[1] + t * ray.d[1];
	hit &= ray.d[2] > 0;
	qx[i] = hit ? (float)x : NAN;
	qy[i] = hit ? (float)y : NAN;
}

SIMD_CLONES static void plane_one(int n, const float *restrict dx, const float *restrict dy, const float *restrict dz,
                                  float *restrict qx, float *restrict qy, double depth, const struct sight *s)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		plane_lane(i, dx, dy, dz, qx, qy, depth, s, false);
}

SIMD_CLONES static void plane_two(int n, const float *restrict dx, const float *restrict dy, const float *restrict dz,
                                  float *restrict qx, float *restrict qy, double depth, const struct sight *s)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		plane_lane(i, dx, dy, dz, qx, qy, depth, s, true);
}

void cornea_sight_plane(int n, const float *dx, const float *dy, const float *dz, float *qx, float *qy, double z,
                        const struct cornea *cornea, const double origin[3])
{
	struct sight sight = sight_of(cornea, origin);
	if (cornea->two_surface)
		plane_two(n, dx, dy, dz, qx, qy, z, &sight);
	else
		plane_one(n, dx, dy, dz, qx, qy, z, &sight);
}

SIMD_INLINE void sight_lane(int i, const struct sight_rays *r, const struct sight *s, bool two)
{
	struct ray ray;
	double K[3], dx = r->dx[i], dy = r->dy[i], dz = r->dz[i];
	bool hit = see(&ray, K, s, two, dx, dy, dz);
	// |d| grew by the index; 1/|d| of an almost unit float direction to first order.
	double unit = (1.5 - 0.5 * (dx * dx + dy * dy + dz * dz)) / s->n;
	r->hit[i] = hit;
	r->kx[i] = hit ? K[0] : 0;
	r->ky[i] = hit ? K[1] : 0;
	r->kz[i] = hit ? K[2] : 0;
	r->fx[i] = hit ? ray.o[0] : 0;
	r->fy[i] = hit ? ray.o[1] : 0;
	r->fz[i] = hit ? ray.o[2] : 0;
	r->ix[i] = hit ? unit * ray.d[0] : 0;
	r->iy[i] = hit ? unit * ray.d[1] : 0;
	r->iz[i] = hit ? unit * ray.d[2] : 0;
}

SIMD_CLONES static void sight_one(const struct sight_rays *rays, const struct sight *s)
{
	struct sight_rays r = *rays;
	SIMD_LOOP
	for (int i = 0; i < r.n; i++)
		sight_lane(i, &r, s, false);
}

SIMD_CLONES static void sight_two(const struct sight_rays *rays, const struct sight *s)
{
	struct sight_rays r = *rays;
	SIMD_LOOP
	for (int i = 0; i < r.n; i++)
		sight_lane(i, &r, s, true);
}

void cornea_sight_batch(const struct sight_rays *rays, const struct cornea *cornea, const double origin[3])
{
	struct sight sight = sight_of(cornea, origin);
	if (cornea->two_surface)
		sight_two(rays, &sight);
	else
		sight_one(rays, &sight);
}
