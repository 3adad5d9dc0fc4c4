/* aspect: */
#ifndef LIMBUS_ASPECT_H
#define LIMBUS_ASPECT_H
#include "limbus/pose.h"

/* Aspect of one eye from n photographs: the most likely value under the prior, and its sigma. */
bool limbus_aspect(double *aspect, double *sigma, int n, const struct pose_view views[n], const struct eye *eye,
                   const struct pose_conf *conf, struct err *err);

#endif
