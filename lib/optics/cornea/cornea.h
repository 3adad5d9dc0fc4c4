/* cornea: the refracting front of the eye, and a ray of sight through it.
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

/* Depth of the front surface at radius r; NAN where r is beyond its equator. */
double cornea_depth(const struct cornea *cornea, double r);

/* Radius at which the surface ends: the rim, or its equator where that comes first. */
double cornea_edge(const struct cornea *cornea);

/* Unit normal at a point of the front surface, out of the eye (-z at the apex). */
void cornea_normal(double normal[3], const struct cornea *cornea, const double K[3]);

/* First hit of the ray origin + t dir, t > 0, with the front surface from outside, inside the rim. */
bool cornea_hit(double K[3], const struct cornea *cornea, const double origin[3], const double dir[3]);

/* Snell: unit direction behind a surface of unit normal N, dir unit and against N (dir·N <= 0), from index n1
 * into n2. False in total reflection. */
bool refract(double out[3], const double dir[3], const double N[3], double n1, double n2);

/* Ray of sight from outside: entry point K, and the unit direction behind the cornea; `from` is where that
 * direction starts (K, or the point on the posterior surface). False when the ray misses the cornea. */
bool cornea_sight(double K[3], double from[3], double inside[3], const struct cornea *cornea,
                  const double origin[3], const double dir[3]);

/* Many rays of sight at once, vectorised, structure of arrays; computed in double, stored in float. */
struct sight_rays {
	int n;
	const float *dx, *dy, *dz;  // [n] unit directions
	float *kx, *ky, *kz;        // [n] entry points K on the front surface, mm
	float *fx, *fy, *fz;        // [n] where the direction inside starts, mm (K in the one-surface model)
	float *ix, *iy, *iz;        // [n] unit directions behind the cornea
	unsigned char *hit;         // [n] 1, or 0 where the ray misses the cornea (the other outputs then are 0)
};

/* All rays start at `origin` (a camera in the eye frame, outside the surface). One or two surfaces. */
void cornea_sight_batch(const struct sight_rays *rays, const struct cornea *cornea, const double origin[3]);

/* The same up to the plane at depth z: qx[n], qy[n] mm, NAN where the ray misses the cornea: all that
 * unrefracting a photograph needs. */
void cornea_sight_plane(int n, const float *dx, const float *dy, const float *dz, float *qx, float *qy, double z,
                        const struct cornea *cornea, const double origin[3]);

#endif
