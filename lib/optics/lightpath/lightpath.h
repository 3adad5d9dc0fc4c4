/* lightpath: the point K of the cornea through which light between P (inside the eye) and C (outside) passes; iris paper section
 * 3, eqs. 2-8, and beyond it. By Fermat's principle L(K) = |CK| + n |KP| is stationary. Eye frame, mm. The front surface alone
 * refracts: cornea->n is the index of everything behind it.
 */
#ifndef OPTICS_LIGHTPATH_LIGHTPATH_H
#define OPTICS_LIGHTPATH_LIGHTPATH_H
#include "optics/cornea/cornea.h"

enum lightpath_status {
	LIGHTPATH_OK,
	LIGHTPATH_BEYOND_RIM,  // K lies outside the limbus: the sclera blocks the path
	LIGHTPATH_GRAZING,     // stationary, but past 90 degrees of incidence: no physical path
	LIGHTPATH_NONE,        // no stationary point: P outside the surface, C inside it, or no number; K is 0 then
};

/* Solves for K by Newton's method in two dimensions from a closed-form start, in double, to 1e-13 mm. K is set whatever the status
 * (BEYOND_RIM: on the surface continued beyond the limbus), and never NaN. */
enum lightpath_status lightpath_solve(double K[3], const struct cornea *cornea, const double P[3], const double C[3]);

/* The same for a source at infinity in unit direction w (from the eye towards the light). */
enum lightpath_status lightpath_solve_directional(double K[3], const struct cornea *cornea, const double P[3],
                                                  const double w[3]);

/* Finds every path through the lit cornea inside the rim, shortest optical length first: K[max].
 * C, w  a point outside; or null, and the light comes from direction w
 * There are several where light from behind the limbus is focused on the far side. None is overlooked; about 0.03 ms. Returns their
 * number, at most max. */
int lightpath_all(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                  const double w[3]);

/* Depth down to which light from the hemisphere before the iris has passed no focus: for P above it there is at most one path,
 * and none where lightpath_solve() returns GRAZING or BEYOND_RIM. 3.3 mm for the generic eye. */
double lightpath_clear_depth(const struct cornea *cornea);

/* Solves n problems in float, vectorised: structure of arrays.
 * px .. pz, wx .. wz  [n] P; w unit, towards the light
 * kx .. kz            [n] out: K
 * status              [n] out: enum lightpath_status; or null
 * steps               Newton steps (4: 2e-5 mm at worst); problems that have not converged are solved one by one in double
 * Finds shortest paths only: where P lies deeper than lightpath_clear_depth() or the light comes from behind, GRAZING may hide a
 * path that lightpath_solve() would find by its search. */
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

/* As lightpath_batch(), with starts of the caller and a tolerance.
 * qx .. qz  [n] the start is where the ray from P in direction q (any length) leaves the surface; null: the closed form
 * error_mm  tolerance of K, mm; 0: the precision of float */
struct lightpath_again {
	long longer, in_double;  // problems that took more than `steps` steps; that were solved again in double
};
struct lightpath_again lightpath_batch_from(int n, const float *qx, const float *qy, const float *qz, const float *px, const float *py, const float *pz,
                          const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz,
                          unsigned char *status, const struct cornea *cornea, int steps, double error_mm);

/* The iris paper's algorithm 1 as printed, with its thresholds; alpha in mm (0.5 = the paper's 0.05 cm). The baseline. */
struct algorithm1_conf {
	double alpha, eps_inner, eps_outer;
	int max_inner, max_outer;
};
enum lightpath_status lightpath_algorithm1(double K[3], const struct cornea *cornea, const double P[3],
                                           const double C[3], const struct algorithm1_conf *conf);

/* Irradiance gain (caustic) of n paths: irradiance at P on a plane facing -z, over the irradiance of the same light on a plane
 * facing it outside: gain[n] = T cos i |dK/dP| / N_z, with T Fresnel's transmittance, i the angle of incidence and N the normal
 * at K. In float; 0 where the light stands behind the surface at K. P, w (unit, towards the light) and K (as solved for them):
 * structure of arrays. */
void lightpath_gain_batch(int n, const float *px, const float *py, const float *pz, const float *wx, const float *wy,
                          const float *wz, const float *kx, const float *ky, const float *kz, float *gain,
                          const struct cornea *cornea);

#endif
