/* lean: the likelihood ratio of the two poses of a limbus from the brightness of the iris.
 * Seen through the cornea, the iris' dark outer border lies farther in on the side turned to the camera and farther
 * out on the other. Projected back to the iris plane under the right pose, brightness depends on the radius alone; under the
 * other pose it also varies round the iris.
 */
#ifndef LIMBUS_PROPOSE_LEAN_H
#define LIMBUS_PROPOSE_LEAN_H
#include "anatomy/fit.h"
#include "limbus/rim.h"

enum { BAND_ARCS = ARCS / 2, BAND_DEPTH = 20 };

/* Logarithm of encoded brightness in the outer part of the iris, along the limbus' normals. */
struct band {
	double p[BAND_ARCS][BAND_DEPTH][2];    // px of the photograph
	float value[BAND_ARCS][BAND_DEPTH];
	bool use[BAND_ARCS];
};

/* Samples the band inside a measured limbus. */
void band_sample(struct band *band, const struct pyramid *pyramid, const struct rim *limbus);

/* Log likelihood ratio of pose a against pose b (cam_from_eye): positive where a is likelier. */
double lean_iris(const struct band *band, const struct camera *camera, const double a[4][4], const double b[4][4],
                 const struct eye *eye);

#endif
