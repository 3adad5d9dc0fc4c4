#include "math/stats.h"

#include <math.h>

static void swap(double *a, double *b)
{
	double t = *a;
	*a = *b;
	*b = t;
}

/* The k-th smallest (k from 0) in linear time on average (Hoare's quickselect); reorders x. n >= 1. */
static double select_kth(int n, double x[n], int k)
{
	int lo = 0, hi = n - 1;
	while (lo < hi) {
		double pivot = x[lo + (hi - lo) / 2];
		int i = lo, j = hi;
		while (i <= j) {
			while (x[i] < pivot)
				i++;
			while (x[j] > pivot)
				j--;
			if (i <= j)
				swap(&x[i++], &x[j--]);
		}
		if (k <= j)
			hi = j;
		else if (k >= i)
			lo = i;
		else
			break;
	}
	return x[k];
}

double stats_quantile(int n, double x[n], double q)
{
	if (n == 0)
		return NAN;
	double at = q * (n - 1);
	int k = (int)at;
	double low = select_kth(n, x, k);
	if (k + 1 >= n || at == k)
		return low;
	double high = select_kth(n - k - 1, x + k + 1, 0);
	return low + (at - k) * (high - low);
}

double stats_median(int n, double x[n])
{
	return stats_quantile(n, x, 0.5);
}

double stats_mad(int n, double x[n], double center)
{
	for (int i = 0; i < n; i++)
		x[i] = fabs(x[i] - center);
	return 1.4826 * stats_median(n, x);
}

double stats_normal_score(double p)
{
	double low = -6, high = 6;
	for (int i = 0; i < 50; i++) {
		double at = (low + high) / 2;
		*(erfc(-at / M_SQRT2) / 2 < p ? &low : &high) = at;
	}
	return (low + high) / 2;
}
