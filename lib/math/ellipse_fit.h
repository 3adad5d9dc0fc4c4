/* ellipse_fit: fitting an ellipse to edge points. Coordinates in px, as ellipse.h. */
#ifndef MATH_ELLIPSE_FIT_H
#define MATH_ELLIPSE_FIT_H
#include "math/ellipse.h"

/* Direct least squares fit (Halir and Flusser 1998, numerically stable Fitzgibbon), coordinates normalised.
 * weight may be null. False: fewer than 5 points, or they hold no ellipse. */
bool ellipse_fit_direct(struct ellipse *e, int n, const double p[n][2], const double *weight);

struct ellipse_fit {
	double sigma;       // robust scale of the distances, px
	double cov_q[ELLIPSE_N][ELLIPSE_N];
	int iterations;
	double inliers;     // sum of the Tukey weights over n
};

/* Maximum likelihood fit, robust: geometric distances, iteratively reweighted with Tukey's biweight (c = 5.5, 97.5 %
 * efficient on clean data).
 * start   e as given, when `have_start`; else random five-point samples (seeded), the best by truncated distance
 * sigma   0: scale from the median absolute deviation; else the known noise of the points, px
 * weights may be null; in: prior weight of a point (1 / variance, relative); out[n] (may be null): Tukey weights
 * Returns false when no ellipse is supported. */
bool ellipse_fit_robust(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2],
                        const double *prior, double *out, double sigma, bool have_start);

#endif
