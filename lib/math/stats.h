/* stats: order statistics, in linear time. The arrays are reordered. */
#ifndef MATH_STATS_H
#define MATH_STATS_H

/* Quantile q in 0..1 by linear interpolation between order statistics. NAN when n = 0. */
double stats_quantile(int n, double x[n], double q);

/* Median; NAN when n = 0. */
double stats_median(int n, double x[n]);

/* 1.4826 times the median absolute deviation from `center`, which estimates sigma of a normal distribution. x is overwritten. */
double stats_mad(int n, double x[n], double center);

/* Standard score below which a share p of a normal distribution lies, 0 <= p <= 1; within -6 .. 6. */
double stats_normal_score(double p);

#endif
