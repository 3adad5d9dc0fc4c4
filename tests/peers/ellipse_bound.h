/* ellipse_bound: the Cramér-Rao bound that ellipse fits are judged by. */
#ifndef PEERS_ELLIPSE_BOUND_H
#define PEERS_ELLIPSE_BOUND_H
#include "math/ellipse.h"

/* Cramér-Rao bound on the covariance of q (ellipse.h), for points at the eccentric angles t[n] (rad) with noise of standard
 * deviation sigma (px, along the normal). False, cov_q unspecified, when the information matrix is singular. */
bool ellipse_bound(double cov_q[ELLIPSE_N][ELLIPSE_N], const struct ellipse *e, int n, const double t[n], double sigma);

#endif
