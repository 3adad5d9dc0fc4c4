/* ellipse_fit: fitting an ellipse to edge points. Coordinates in px, as ellipse.h. */
#ifndef MATH_ELLIPSE_FIT_H
#define MATH_ELLIPSE_FIT_H
#include "math/ellipse.h"

/* Fits an ellipse to points p[n] by direct least squares (Halir and Flusser 1998, a numerically stable form of Fitzgibbon, Pilu and
 * Fisher's), coordinates normalised. weight: of each point, or null. Returns false for fewer than 5 points and where the solution
 * is no ellipse. */
bool ellipse_fit_direct(struct ellipse *e, int n, const double p[n][2], const double *weight);

struct ellipse_fit {
	double sigma;       // robust scale of the distances, px
	double cov_q[ELLIPSE_N][ELLIPSE_N];    // covariance of q (ellipse.h) for the errors of the points, as though independent
	double known_q[ELLIPSE_N][ELLIPSE_N];  // besides, for that of what was known; 0 where nothing was
	int iterations;
	double inliers;     // sum of the Tukey weights over n
};

/* Fits an ellipse to points p[n] robustly: an M-estimate on geometric distances, iteratively reweighted least squares with Tukey's
 * biweight (c = 5.5, 97.5 % efficient on clean data).
 * e           in: the start, if have_start; else the start is the best of random five-point samples (seeded) by the 55 % quantile
 *             of distances. out: the fit
 * prior       [n] weights of the points, 1 / variance, relative; or null
 * out         [n] Tukey weights, 0..1; or null
 * sigma       noise of the points, px; 0: their scale is estimated by the median absolute deviation
 * Returns false for fewer than 5 points and where too few agree on an ellipse. */
bool ellipse_fit_robust(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2],
                        const double *prior, double *out, double sigma, bool have_start);

/* What is known of an ellipse before: Gaussian, its parameters independent. */
struct ellipse_prior {
	double q[ELLIPSE_N], sigma[ELLIPSE_N];  // px
	double alike;                           // so many points count as one against it: their errors are correlated
};

/* The same from a start, with a prior: where points tell little, the ellipse and its covariance are the prior's. Where c points err together
 * the ellipse's covariance is c cov_q + known_q, whatever known->alike weighs them by. sigma: least noise of the points, px. */
bool ellipse_fit_near(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2], const double *weight, double *out,
                      double sigma, const struct ellipse_prior *known);

#endif
