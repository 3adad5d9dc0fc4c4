#include "tissue/pigment/white_pair.h"

#include <math.h>

enum { NODES = 121 };
static const double step = 0.01, above = 0.2;  // of the lattice; so far above the higher measurement

void chroma_of(double out[CHROMA], const double rgb[3])
{
	out[0] = log(rgb[0] / rgb[1]);
	out[1] = log(rgb[2] / rgb[1]);
}

/* ln of Student's density with two degrees of freedom, but for a constant. */
static double student(double x, double scale)
{
	return -1.5 * log1p(x * x / (2 * scale * scale));
}

/* ln likelihood of a measurement that is higher by x than the light: a normal one, or one with an exponential besides. */
static double measured(double x, const struct white_pair_conf *c)
{
	double s = c->sigma, m = c->skin[1], clean = exp(-x * x / (2 * s * s)) / (s * sqrt(2 * M_PI));
	double mixed = exp(fmin(s * s / (2 * m * m) - x / m, 300)) / (2 * m) * erfc((s / m - x / s) / sqrt(2));
	return log((1 - c->skin[0]) * clean + c->skin[0] * mixed + 1e-300);
}

/* One ratio, of which skin has more. */
static double joined(double own, double fellow, const double *iris, const struct white_pair_conf *c)
{
	double own_like[NODES], fellow_like[NODES], apart[2 * NODES - 1], top = -INFINITY, sum = 0, mean = 0;
	double high = fmax(own, fellow) + above, span = high - fmin(own, fellow) + 0.5, pitch = fmax(step, span / (NODES - 1));
	for (int i = 0; i < NODES; i++) {
		own_like[i] = measured(own - (high - pitch * i), c);
		fellow_like[i] = measured(fellow - (high - pitch * i), c);
	}
	for (int d = 0; d < 2 * NODES - 1; d++) {  // own light less the other's
		double x = pitch * (NODES - 1 - d);
		apart[d] = student(x, c->light) + (iris ? student(x - *iris, c->iris) : 0);
	}
	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < NODES; i++)
			for (int k = 0; k < NODES; k++) {
				double p = own_like[i] + fellow_like[k] + apart[NODES - 1 + i - k];
				if (!pass) {
					top = fmax(top, p);
				} else {
					p = exp(p - top);
					sum += p;
					mean += p * (high - pitch * i);
				}
			}
	return mean / sum;
}

void white_pair(double out[CHROMA], const double own[CHROMA], const double fellow[CHROMA], const double *iris, const struct white_pair_conf *conf)
{
	double other = iris ? -iris[1] : 0;
	out[0] = joined(own[0], fellow[0], iris, conf);
	out[1] = -joined(-own[1], -fellow[1], iris ? &other : 0, conf);
}
