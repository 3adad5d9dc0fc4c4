/* aspect: the aspect of one eye's limbus (vertical / horizontal) from several photographs. */
#ifndef LIMBUS_ASPECT_H
#define LIMBUS_ASPECT_H
#include "limbus/pose.h"

/* Estimates the aspect: the maximum of the posterior under conf's Gaussian prior, searched on a grid and a finer one.
 * aspect, sigma  out; sigma: the standard deviation of the posterior, at most the prior's
 * False, err set, when a view has no pose. */
bool limbus_aspect(double *aspect, double *sigma, int n, const struct pose_view views[n], const struct eye *eye,
                   const struct pose_conf *conf, struct err *err);

#endif
