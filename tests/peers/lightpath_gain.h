/* lightpath_gain: the caustic of one path in double, by its closed form: what lightpath_gain_batch is compared with. Eye frame, mm. */
#ifndef PEERS_LIGHTPATH_GAIN_H
#define PEERS_LIGHTPATH_GAIN_H
#include "optics/lightpath/lightpath.h"

/* Irradiance at P on a plane facing -z, over the irradiance of the same light on a plane facing it outside:
 * T cos i |dK/dP| / N_z (the caustic). K as solved for P and w. */
double lightpath_gain(const struct cornea *cornea, const double P[3], const double w[3], const double K[3]);

/* The sum of the gains of all paths from direction w to P. */
double lightpath_irradiance(const struct cornea *cornea, const double P[3], const double w[3]);

#endif
