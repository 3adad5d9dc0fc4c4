#include "math/stats.h"

#include <math.h>
#include <stdbool.h>

#include "math/simd.h"

enum { FEW = 64 };  // so few are ranked by comparing all pairs: no branch that depends on them

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

/* rank[i]: how many come before x[i] in rising order; of equal ones the earlier. room: a multiple of 8, n at least; beyond n x is not read as a rank. */
SIMD_CLONES static void ranks(long rank[FEW], const double x[FEW], int n, int room)
{
	for (int i = 0; i < room; i++)
		rank[i] = 0;
	for (int j = 0; j < n; j++) {
		SIMD_LOOP
		for (int i = 0; i < room; i++)
			rank[i] += (x[j] < x[i]) | ((x[j] == x[i]) & (j < i));
	}
}

/* Median of at most FEW; false where NaNs leave a rank empty. */
static bool median_of_few(double *median, int n, const double x[n])
{
	double all[FEW], low = 0, high = 0;
	long rank[FEW];
	const int k = (n - 1) / 2;
	int found = 0;
	for (int i = 0; i < FEW; i++)
		all[i] = i < n ? x[i] : 0;
	ranks(rank, all, n, (n + 7) / 8 * 8);
	for (int i = 0; i < n; i++) {
		if (rank[i] == k)
			low = x[i], found++;
		if (rank[i] == k + 1)
			high = x[i], found++;
	}
	*median = n % 2 ? low : low + 0.5 * (high - low);
	return found == (n > 1 ? 2 : 1);
}

double stats_median(int n, double x[n])
{
	double few;
	return n > 0 && n <= FEW && median_of_few(&few, n, x) ? few : stats_quantile(n, x, 0.5);
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
