#include "limbus/rice.h"

#include <math.h>

enum { STEPS = 400, TURNS = 320 };
static const double REACH = 8;    // sigmas
static const double LEAST = 0.06; // sigma across the larger one: what the steps resolve

/* exp(-x) I0(x), x >= 0: Abramowitz and Stegun 9.8.1, 9.8.2. */
static double bessel_scaled(double x)
{
	if (x < 3.75) {
		const double t = x / 3.75, s = t * t;
		return exp(-x) * (1 + s * (3.5156229 + s * (3.0899424 + s * (1.2067492 + s * (0.2659732 + s * (0.0360768 + s * 0.0045813))))));
	}
	const double t = 3.75 / x;
	return (0.39894228
	        + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565 + t * (0.00916281 + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377))))))))
	       / sqrt(x);
}

void rice_tilt(double *mean, double *deviation, double theta, double sigma, double prior)
{
	const double seen = theta * theta, low = fmax(seen - REACH * sigma, 0), high = fmin(seen + REACH * sigma, M_PI * M_PI / 4);
	double sum = 0, one = 0, two = 0;
	*mean = theta;
	*deviation = 0;
	if (!(sigma > 0) || !(high > low))
		return;
	for (int i = 0; i < STEPS; i++) {
		const double u = low + (i + 0.5) / STEPS * (high - low), off = (u - seen) / sigma, t = sqrt(u);
		const double chance = bessel_scaled(u * seen / (sigma * sigma)) * exp(-0.5 * off * off - (prior > 0 ? 0.5 * u / (prior * prior) : 0));
		sum += chance;
		one += chance * (t - theta);
		two += chance * (t - theta) * (t - theta);
	}
	if (!(sum > 0))
		return;
	*mean = theta + one / sum;
	*deviation = sqrt(fmax(two / sum - one / sum * one / sum, 0));
}

/* Inverse of the covariance along and across the measured vector, and its largest sigma. */
static double precision(double inv[3], double phi, const double cov[2][2])
{
	const double c = cos(2 * phi), s = sin(2 * phi);
	double xx = c * c * cov[0][0] + 2 * c * s * cov[0][1] + s * s * cov[1][1], yy = s * s * cov[0][0] - 2 * c * s * cov[0][1] + c * c * cov[1][1];
	const double xy = c * s * (cov[1][1] - cov[0][0]) + (c * c - s * s) * cov[0][1];
	const double largest = (xx + yy) / 2 + hypot((xx - yy) / 2, xy), more = pow(LEAST, 2) * largest;
	xx += more;
	yy += more;
	const double det = xx * yy - xy * xy;
	inv[0] = yy / det;
	inv[1] = -xy / det;
	inv[2] = xx / det;
	return sqrt(largest);
}

/* Sums over the plane of the vectors, in polar coordinates: the squares of tilts in all directions are spread like 1 / length. */
double rice_astray(double about, double theta, double phi, const double cov[2][2], double prior)
{
	double inv[3], sum = 0, two = 0;
	const double sigma = precision(inv, phi, cov), seen = theta * theta;
	const double low = fmax(seen - REACH * sigma, 0), high = fmin(seen + REACH * sigma, M_PI * M_PI / 4);
	if (!(sigma > 0) || !(high > low))
		return fabs(theta - about);
	const double wide = fmin(REACH * sigma / fmax(low, 1e-12), M_PI);
	for (int i = 0; i < TURNS; i++) {
		const double u = low + (i + 0.5) / TURNS * (high - low);
		double chance = 0;
		for (int j = 0; j < TURNS; j++) {
			const double turn = ((j + 0.5) / TURNS * 2 - 1) * wide, x = u * cos(turn) - seen, y = u * sin(turn);
			chance += exp(-0.5 * (inv[0] * x * x + 2 * inv[1] * x * y + inv[2] * y * y));
		}
		chance *= prior > 0 ? exp(-0.5 * u / (prior * prior)) : 1;
		sum += chance;
		two += chance * pow(sqrt(u) - about, 2);
	}
	return sum > 0 ? sqrt(two / sum) : fabs(theta - about);
}
