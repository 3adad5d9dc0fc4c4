#include "motion/saccade.h"

#include <math.h>

double minimum_jerk(double t)
{
	t = fmin(1, fmax(0, t));
	return t * t * t * (10 + t * (6 * t - 15));
}

/* Peak over mean of t^a (1 - t)^b with a + b = n and the peak at t = m: closed form by the beta function. */
static double peak_over_mean(double n, double m)
{
	double a = n * m, b = n * (1 - m);
	return exp(a * log(m) + b * log(1 - m) - (lgamma(a + 1) + lgamma(b + 1) - lgamma(n + 2)));
}

void saccade_make(struct saccade *s, double amplitude, const struct saccade_conf *conf)
{
	s->amplitude = amplitude;
	s->duration = conf->duration_s + conf->duration_per_deg * amplitude;
	s->peak = conf->peak_ratio * amplitude / s->duration;
	double along = fmin(1, fmax(0, (amplitude - 1) / 39)), m = conf->skew_short + (conf->skew_long - conf->skew_short) * along;
	double low = 0, high = 64;  // grows with n: from 1, a box, without limit
	for (int i = 0; i < 60; i++) {
		double n = 0.5 * (low + high);
		*(peak_over_mean(n, m) < conf->peak_ratio ? &low : &high) = n;
	}
	double n = 0.5 * (low + high), sum = 0;
	enum { FINE = 16 };
	s->course[0] = 0;
	for (int i = 0; i < SACCADE_TABLE; i++) {
		for (int k = 0; k < FINE; k++) {
			double t = (i + (k + 0.5) / FINE) / SACCADE_TABLE;
			sum += pow(t, n * m) * pow(1 - t, n * (1 - m));
		}
		s->course[i + 1] = sum;
	}
	for (int i = 1; i <= SACCADE_TABLE; i++)
		s->course[i] /= sum;
}

double saccade_at(const struct saccade *s, double t)
{
	double u = t / s->duration * SACCADE_TABLE;
	if (!(u > 0))
		return 0;
	int i = (int)fmin(u, SACCADE_TABLE);
	return i == SACCADE_TABLE ? 1 : s->course[i] + (u - i) * (s->course[i + 1] - s->course[i]);
}
