#include "limbus/aspect.h"

#include <math.h>

enum { STEPS = 7, ROUNDS = 3 };

/* Minus log likelihood of all photographs at a given aspect. */
static bool cost_at(double *cost, double aspect, int n, const struct pose_view views[n], const struct eye *eye,
                    const struct pose_conf *conf, struct err *err)
{
	struct pose_conf fixed = *conf;
	fixed.aspect_mean = aspect;
	fixed.aspect_sigma = 0;
	double z = (aspect - conf->aspect_mean) / conf->aspect_sigma;
	*cost = z * z / 2;
	for (int i = 0; i < n; i++) {
		struct pose pose;
		if (!limbus_pose(&pose, &views[i], eye, &fixed, err))
			return false;
		*cost += pose.cost;
	}
	return true;
}

bool limbus_aspect(double *aspect, double *sigma, int n, const struct pose_view views[n], const struct eye *eye,
                   const struct pose_conf *conf, struct err *err)
{
	/* A grid, then finer ones round its best: the likelihood of several views need not have one hill. */
	double center = conf->aspect_mean, half = 4 * conf->aspect_sigma, cost[STEPS] = { 0 };
	for (int round = 0; round < ROUNDS; round++) {
		const double step = 2 * half / (STEPS - 1);
		int best = 0;
		struct err bad[STEPS] = { 0 };
#pragma omp parallel for schedule(dynamic)
		for (int i = 0; i < STEPS; i++)
			cost_at(&cost[i], center + (i - STEPS / 2) * step, n, views, eye, conf, &bad[i]);
		for (int i = 0; i < STEPS; i++) {
			if (err_is(&bad[i])) {
				*err = bad[i];
				return false;
			}
			if (cost[i] < cost[best])
				best = i;
		}
		center += (best - STEPS / 2) * step;
		int mid = best < 1 ? 1 : best > STEPS - 2 ? STEPS - 2 : best;
		double curve = (cost[mid - 1] - 2 * cost[mid] + cost[mid + 1]) / (step * step);
		*sigma = curve > 0 ? fmin(1 / sqrt(curve), conf->aspect_sigma) : conf->aspect_sigma;
		half = 1.5 * step;
	}
	*aspect = center;
	return true;
}
