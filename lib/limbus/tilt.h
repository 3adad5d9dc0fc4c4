/* tilt: a start value of an eye's tilt from its ellipse. Picture coordinates have their origin at the ellipse's centre; the
 * principal point lies at `center`, in the same unit as the focal length.
 */
#ifndef LIMBUS_TILT_H
#define LIMBUS_TILT_H
#include "math/ellipse_type.h"

/* Rotation from the camera turned towards the ellipse's centre to the camera. */
void limbus_sight(double R[3][3], const double center[2], double focal);

/* Tilt against the line of sight and the direction towards which it is (or its opposite), in the picture of the turned camera, radians, of an
 * ellipse of the aspect (vertical / horizontal), its axes turned by level, that is seen as e: from the ellipse as the turned camera shows it, because at the picture's edge
 * perspective stretches circles that are not tilted. Weak perspective: with S = A A^T the seen shape and D = diag(1, aspect), the foreshortening
 * F = I - (1 - cos tilt) t t^T solves F D^2 F ~ S, which has one positive solution, D^-1 (D S D)^1/2 D^-1, up to its scale. */
void limbus_tilt(double *tilt, double *across, const struct ellipse *e, const double center[2], double focal, double aspect, double level);

#endif
