#include "limbus/rice.h"

#include <math.h>
#include <stdbool.h>

enum { STEPS = 400, TURNS = 320 };
static const double REACH = 8;    // sigmas
static const double LEAST = 0.06; // sigma across the larger one: what the steps resolve

double rice_square_sigma(double theta, double sigma)
{
	return pow(theta + sigma, 2) - pow(theta, 2);
}

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

/* Of the square u of a tilt, given a measured one: both relative to any other. All directions of sight as likely: u is, too. */
static double chance_of(double u, double seen, double sigma, double prior)
{
	const double off = (u - seen) / sigma;
	return bessel_scaled(u * seen / (sigma * sigma)) * exp(-0.5 * off * off - (prior > 0 ? 0.5 * u / (prior * prior) : 0));
}

static bool range_of(double *low, double *high, double seen, double sigma)
{
	*low = fmax(seen - REACH * sigma, 0);
	*high = fmin(seen + REACH * sigma, M_PI * M_PI / 4);
	return sigma > 0 && *high > *low;
}

void rice_tilt(double *mean, double *deviation, double theta, double sigma, double prior)
{
	double sum = 0, one = 0, two = 0, low, high;
	*mean = theta;
	*deviation = 0;
	if (!range_of(&low, &high, theta * theta, sigma))
		return;
	for (int i = 0; i < STEPS; i++) {
		const double u = low + (i + 0.5) / STEPS * (high - low), t = sqrt(u), chance = chance_of(u, theta * theta, sigma, prior);
		sum += chance;
		one += chance * (t - theta);
		two += chance * (t - theta) * (t - theta);
	}
	if (!(sum > 0))
		return;
	*mean = theta + one / sum;
	*deviation = sqrt(fmax(two / sum - one / sum * one / sum, 0));
}

double rice_log_evidence(double theta, double sigma, double prior)
{
	double sum = 0, low, high;
	if (!range_of(&low, &high, theta * theta, sigma))
		return -INFINITY;
	for (int i = 0; i < STEPS; i++)
		sum += chance_of(low + (i + 0.5) / STEPS * (high - low), theta * theta, sigma, prior);
	return log(sum * (high - low) / (STEPS * sigma * sigma));
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
	double low, high;
	const double sigma = precision(inv, phi, cov), seen = theta * theta;
	if (!range_of(&low, &high, seen, sigma))
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
