/* cornea: the cornea as one or two conic surfaces of revolution, and rays of sight through it.
 * Eye frame: origin at the corneal apex, z into the eye, mm. Front surface x² + y² − 2Rz + pz² = 0
 * (iris paper eq. 1 with z turned inwards).
 */
#ifndef OPTICS_CORNEA_CORNEA_H
#define OPTICS_CORNEA_CORNEA_H
#include <stdbool.h>

struct cornea {
	double R, p;     // apical radius mm, asphericity >= 0
	double n;        // index behind the surface, >= 1; 1.336 in the one-surface model
	double rim;      // radius of the limbus, mm: no surface beyond
	bool two_surface;
	double R_post, p_post, thickness, n_cornea;  // posterior surface, apex at z = thickness; n then is the aqueous
};

/* Depth z of the front surface at distance r from the axis; NAN where r is beyond the surface's equator. */
double cornea_depth(const struct cornea *cornea, double r);

/* Distance from the axis at which the surface ends: the rim, or the equator where that is smaller. */
double cornea_edge(const struct cornea *cornea);

/* Unit normal at a point of the front surface, out of the eye (-z at the apex). */
void cornea_normal(double normal[3], const struct cornea *cornea, const double K[3]);

/* First point K where the ray origin + t dir, t > 0, meets the front surface from outside and inside the rim. Returns false when
 * there is none. */
bool cornea_hit(double K[3], const struct cornea *cornea, const double origin[3], const double dir[3]);

/* Snell's law: the unit direction behind a surface of unit normal N, of a ray with unit direction dir, against N (dir·N <= 0),
 * from index n1 into n2. Returns false in total reflection. */
bool refract(double out[3], const double dir[3], const double N[3], double n1, double n2);

/* Traces a ray of sight from outside, origin + t dir, through the cornea.
 * K       out: entry point on the front surface
 * from    out: where the direction inside starts: K, or the point on the posterior surface
 * inside  out: unit direction behind the cornea
 * Returns false when the ray misses the cornea. */
bool cornea_sight(double K[3], double from[3], double inside[3], const struct cornea *cornea,
                  const double origin[3], const double dir[3]);

/* n rays of sight, traced at once (vectorised): structure of arrays. Computed in double, stored in float. */
struct sight_rays {
	int n;
	const float *dx, *dy, *dz;  // [n] unit directions
	float *kx, *ky, *kz;        // [n] entry points K on the front surface, mm
	float *fx, *fy, *fz;        // [n] where the direction inside starts, mm (K in the one-surface model)
	float *ix, *iy, *iz;        // [n] unit directions behind the cornea
	unsigned char *hit;         // [n] 1, or 0 where the ray misses the cornea (the other outputs then are 0)
};

/* Traces rays that all start at `origin` (a camera in the eye frame, outside the surface) through one or two surfaces. */
void cornea_sight_batch(const struct sight_rays *rays, const struct cornea *cornea, const double origin[3]);

/* The same up to the plane at depth z: points qx[n], qy[n], mm; NAN where the ray misses the cornea. */
void cornea_sight_plane(int n, const float *dx, const float *dy, const float *dz, float *qx, float *qy, double z,
                        const struct cornea *cornea, const double origin[3]);

#endif
