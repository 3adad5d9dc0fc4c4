/* stats: order statistics and small sums. Arrays are reordered where said. */
#ifndef MATH_STATS_H
#define MATH_STATS_H

/* Quantile 0..1 by linear interpolation; reorders x. NAN when n = 0. */
double stats_quantile(int n, double x[n], double q);

double stats_median(int n, double x[n]);

/* 1.4826 times the median of |x - center|: sigma of a normal distribution. x is overwritten. */
double stats_mad(int n, double x[n], double center);

#endif
