/* refraction: the refraction function f(P, w) -> K of one eye (iris paper section 5.1, eq. 15): where light from
 * direction w (unit, towards the light) that reaches P on the iris enters the cornea. Eye frame, mm. One surface.
 * The paper tabulates it. Here it is a start, closed-form or a small polynomial, polished by as many Newton steps as
 * an error in mm needs; the tables remain as the baseline.
 */
#ifndef OPTICS_REFRACTION_REFRACTION_H
#define OPTICS_REFRACTION_REFRACTION_H
#include "optics/lightpath/lightpath.h"

enum refraction_method {
	REFRACTION_AUTO,           // the cheaper of the next two for the error
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
	double error_mm;            // error of K that is good enough; 0: as good as float is
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

/* Chooses, fits or tabulates, and measures. The same result on any number of threads. */
void refraction_make(struct refraction *f, const struct cornea *cornea, const struct refraction_conf *conf);
void refraction_free(struct refraction *f);

/* n evaluations, structure of arrays. P on the iris plane or near it (relief); a table knows the plane only. Light
 * from outside the hemisphere is solved without start or table.
 * gain  [n] or null: irradiance gain (lightpath_gain_batch), 0 where there is no path
 * status [n] or null: enum lightpath_status */
void refraction_batch(const struct refraction *f, int n, const float *px, const float *py, const float *pz,
                      const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz, float *gain,
                      unsigned char *status);

/* Bytes that the method needs at run time. */
long refraction_bytes(const struct refraction *f);

#endif
