/* refraction: the refraction function f(P, w) -> K of one eye (iris paper section 5.1, eq. 15): the point K where light from
 * direction w (unit, towards the light) that reaches P on the iris enters the cornea. Eye frame, mm. One surface.
 * The paper tabulates it. Here a start, in closed form or by a small polynomial, is refined by as many Newton steps as a
 * tolerance in mm needs; tables remain as the baseline.
 */
#ifndef OPTICS_REFRACTION_REFRACTION_H
#define OPTICS_REFRACTION_REFRACTION_H
#include "optics/lightpath/lightpath.h"

enum refraction_method {
	REFRACTION_AUTO,           // the cheaper of the next two for the tolerance
	REFRACTION_NEWTON,         // closed-form start, nothing stored
	REFRACTION_POLYNOMIAL,     // start along a ray bent by polynomials
	REFRACTION_TABLE_LINEAR,   // the paper's table, interpolated
	REFRACTION_TABLE_NEAREST,  // its nearest sample
	REFRACTION_METHODS
};
extern const char *const refraction_methods[];  // their names; null-terminated

/* Settings. */
struct refraction_conf {
	int method;
	double error_mm;            // tolerance of K; 0: the precision of float
	int points, directions;     // of a table: points on a radius of the iris, directions over the hemisphere
	double radius;              // of the iris, mm
	double depth;               // of the iris plane, mm
};

enum { REFRACTION_MAX_DEGREE = 3 };

struct refraction {
	struct cornea cornea;
	double depth, radius, error_mm;
	int method;                 // never REFRACTION_AUTO
	int steps;                  // Newton steps after the start
	int degree;                 // of the polynomial
	int points, thetas, phis;   // of the table: radius × angle from the axis 0..90° × azimuth 0..180° from P's
	float (*data)[3];           // polynomial: coefficients of gamma, beta (poly.c), 0; table: K. Owned
	long n_data;
	double worst_mm, mean_mm;   // measured against the solver in double, light from the hemisphere, K inside the rim
};

/* Makes the refraction function of a cornea: chooses the method, fits or tabulates, and measures its error. The same result on
 * any number of threads. refraction_free. */
void refraction_make(struct refraction *f, const struct cornea *cornea, const struct refraction_conf *conf);
void refraction_free(struct refraction *f);

/* n evaluations, structure of arrays: P and w in, K out. P is on the iris plane or near it (relief); a table holds for the plane
 * only. Light from behind the iris plane is solved without start or table.
 * gain  [n] or null: irradiance gain (lightpath_gain_batch), 0 where there is no path
 * status [n] or null: enum lightpath_status */
void refraction_batch(const struct refraction *f, int n, const float *px, const float *py, const float *pz,
                      const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz, float *gain,
                      unsigned char *status);

/* Bytes of data that the method keeps. */
long refraction_bytes(const struct refraction *f);

#endif
