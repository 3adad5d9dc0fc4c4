#include "limbus/rice.h"

#include <math.h>

enum { STEPS = 400 };
static const double REACH = 8;  // sigmas

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
