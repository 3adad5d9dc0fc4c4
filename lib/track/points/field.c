/* Where a point should be by the motion of its neighbours. */
#include <math.h>

#include "math/stats.h"
#include "track/points/skin_track_impl.h"

/* Place of point i predicted by neighbour j: its affine warp extrapolated. */
static void seen_from(double out[2], const struct skin_track *t, int i, int j)
{
	const struct patch_warp *w = &t->point[j].warp;
	double d[2] = { t->points.at[i][0] - t->points.at[j][0], t->points.at[i][1] - t->points.at[j][1] };
	for (int r = 0; r < 2; r++)
		out[r] = w->at[r] + w->A[r][0] * d[0] + w->A[r][1] * d[1];
}

static double pow2(double x)
{
	return x * x;
}

/* Robust mean of the predictions: one step from the median with Tukey weights; near neighbours weigh more. */
static void ask(struct skin_field *f, const struct skin_track *t, int i)
{
	double at[SKIN_NEAR_MAX][2], x[SKIN_NEAR_MAX], weight[SKIN_NEAR_MAX], mid[2];
	int who[SKIN_NEAR_MAX], n = 0;
	*f = (struct skin_field){ 0 };
	for (int k = t->points.first[i]; k < t->points.first[i + 1] && n < SKIN_NEAR_MAX; k++)
		if (t->point[t->points.near[k]].seen) {
			who[n] = t->points.near[k];
			seen_from(at[n], t, i, who[n]);
			n++;
		}
	if (n <= 0)
		return;
	for (int r = 0; r < 2; r++) {
		for (int k = 0; k < n; k++)
			x[k] = at[k][r];
		mid[r] = stats_median(n, x);
	}
	for (int k = 0; k < n; k++)
		x[k] = sqrt(pow2(at[k][0] - mid[0]) + pow2(at[k][1] - mid[1]));
	double scale = fmax(3 * stats_median(n, x), 0.5), sum = 0, far = 0;
	for (int k = 0; k < n; k++) {
		double r = sqrt(pow2(at[k][0] - mid[0]) + pow2(at[k][1] - mid[1])) / scale, d2 = 0;
		for (int c = 0; c < 2; c++)
			d2 += pow2(t->points.at[i][c] - t->points.at[who[k]][c]);
		weight[k] = r < 1 ? (1 - r * r) * (1 - r * r) / (d2 + 25) : 0;
		sum += weight[k];
	}
	for (int k = 0; k < n; k++) {
		double w = weight[k] / sum;
		for (int r = 0; r < 2; r++) {
			f->warp.at[r] += w * at[k][r];
			for (int c = 0; c < 2; c++)
				f->warp.A[r][c] += w * t->point[who[k]].warp.A[r][c];
		}
	}
	for (int k = 0; k < n; k++)
		far += weight[k] / sum * (pow2(at[k][0] - f->warp.at[0]) + pow2(at[k][1] - f->warp.at[1]));
	f->spread = sqrt(far);
	f->n = n;
}

void skin_track_ask(struct skin_track *t)
{
#pragma omp parallel for schedule(static)
	for (int i = 0; i < t->points.n; i++)
		ask(&t->field[i], t, i);
}
