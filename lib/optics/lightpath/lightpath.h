/* lightpath: the point K of the cornea through which light between P (inside) and C (outside) goes; iris paper
 * section 3, eqs. 2-8, and beyond it. Fermat: L(K) = |CK| + n |KP| is stationary. Eye frame, mm. Front surface
 * alone: cornea->n is taken for all that lies behind it.
 */
#ifndef OPTICS_LIGHTPATH_LIGHTPATH_H
#define OPTICS_LIGHTPATH_LIGHTPATH_H
#include "optics/cornea/cornea.h"

enum lightpath_status {
	LIGHTPATH_OK,
	LIGHTPATH_BEYOND_RIM,  // the path meets the surface outside the limbus: blocked by the sclera
	LIGHTPATH_GRAZING,     // stationary, but past 90 degrees of incidence: no physical path
	LIGHTPATH_NONE,        // no stationary point: P outside the surface, C inside it, or no number; K is 0 then
};

/* Newton in two dimensions from the closed-form start, double, to 1e-13 mm. K is set whatever the status
 * (BEYOND_RIM: on the surface continued beyond the limbus). Never NaN. */
enum lightpath_status lightpath_solve(double K[3], const struct cornea *cornea, const double P[3], const double C[3]);

/* The same for a source at infinity in unit direction w (from the eye towards the light). */
enum lightpath_status lightpath_solve_directional(double K[3], const struct cornea *cornea, const double P[3],
                                                  const double w[3]);

/* Every path through the lit cornea inside the rim, shortest optical length first; their number, at most max.
 * C: a point outside; or null, and the light comes from direction w. Several exist where light from behind the
 * limbus is focused on the far side. None is overlooked; about 0.03 ms. */
int lightpath_all(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                  const double w[3]);

/* Depth to which light from the hemisphere before the iris has met no focus: above it a path is the only one, and where
 * lightpath_solve() finds it grazing or beyond the rim there is none. 3.3 mm for the generic eye. */
double lightpath_clear_depth(const struct cornea *cornea);

/* n solves in float, structure of arrays, vectorised: px[n] .. wz[n] in (w: unit, towards the light),
 * kx[n] .. kz[n] out; status[n] may be null. steps: Newton steps (4: 2e-5 mm worst). What has not converged
 * after them is solved one by one in double. Shortest paths only: where P lies deeper than lightpath_clear_depth() or the
 * light comes from behind, GRAZING may hide a path that lightpath_solve() would find by a search. */
void lightpath_batch(int n, const float *px, const float *py, const float *pz, const float *wx, const float *wy,
                     const float *wz, float *kx, float *ky, float *kz, unsigned char *status,
                     const struct cornea *cornea, int steps);

/* The same towards one point C outside. */
void lightpath_batch_point(int n, const float *px, const float *py, const float *pz, const double C[3], float *kx,
                           float *ky, float *kz, unsigned char *status, const struct cornea *cornea, int steps);

/* Both in double (6 steps: 1e-12 mm). */
void lightpath_batch_double(int n, const double *px, const double *py, const double *pz, const double *wx,
                            const double *wy, const double *wz, double *kx, double *ky, double *kz,
                            unsigned char *status, const struct cornea *cornea, int steps);
void lightpath_batch_point_double(int n, const double *px, const double *py, const double *pz, const double C[3],
                                  double *kx, double *ky, double *kz, unsigned char *status,
                                  const struct cornea *cornea, int steps);

/* lightpath_batch() with an error in mm that is good enough (0: as good as float is), from starts of the caller's:
 * where the ray from P in direction q (any length) leaves the surface; q null: the closed form. */
struct lightpath_again {
	long longer, in_double;  // problems that took more steps than asked for; that float could not tell
};
struct lightpath_again lightpath_batch_from(int n, const float *qx, const float *qy, const float *qz, const float *px, const float *py, const float *pz,
                          const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz,
                          unsigned char *status, const struct cornea *cornea, int steps, double error_mm);

/* The paper's algorithm 1 as printed, with its thresholds; alpha in mm (0.5 = the paper's 0.05 cm). */
struct algorithm1_conf {
	double alpha, eps_inner, eps_outer;
	int max_inner, max_outer;
};
enum lightpath_status lightpath_algorithm1(double K[3], const struct cornea *cornea, const double P[3],
                                           const double C[3], const struct algorithm1_conf *conf);

/* Irradiance gain (caustic) of n paths: irradiance at P on a plane facing -z, over the irradiance of the same light on a plane facing it
 * outside: gain[n] = T cos i |dK/dP| / N_z, with T Fresnel's transmittance, i the angle of incidence and N the normal at K. In float;
 * 0 where the light stands behind the surface at K. P, w (unit, towards the light) and K (as solved for them): structure of arrays. */
void lightpath_gain_batch(int n, const float *px, const float *py, const float *pz, const float *wx, const float *wy,
                          const float *wz, const float *kx, const float *ky, const float *kz, float *gain,
                          const struct cornea *cornea);

#endif
