/* limbus_tilt: a first idea of an eye's tilt from its ellipse. Picture coordinates here begin at the ellipse's centre: the optical
 * centre lies at center, focal lengths in the same unit.
 */
#ifndef LIMBUS_TILT_H
#define LIMBUS_TILT_H
#include "math/ellipse_type.h"

/* The rotation of a camera that is turned towards the ellipse's centre: camera from turned camera. */
void limbus_sight(double R[3][3], const double center[2], double focal);

/* Tilt against the line of sight (radians), and the direction in the turned camera's picture across which: from the ellipse as the
 * turned camera shows it, since at the picture's edge perspective stretches what is not tilted. */
void limbus_tilt(double *tilt, double *across, const struct ellipse *e, const double center[2], double focal);

#endif
