#include "limbus/aspect.h"

#include <math.h>

/* A first grid over the prior, a finer one round its likeliest. */
enum { STEPS = 11, ROUNDS = 2 };
static const double REACH = 4;  // sigmas

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

/* The likeliest of a grid round center, and the standard deviation of what all of it says. The likelihood of several views need not have one
 * hill, and a view's two poses put a notch into it: sums, no curvature. */
static void read_grid(double *likeliest, double *sigma, const double cost[STEPS], double center, double step)
{
	int best = 0;
	double sum = 0, one = 0, two = 0;
	for (int i = 1; i < STEPS; i++)
		if (cost[i] < cost[best])
			best = i;
	for (int i = 0; i < STEPS; i++) {
		const double chance = exp(cost[best] - cost[i]), x = (i - STEPS / 2) * step;
		sum += chance;
		one += chance * x;
		two += chance * x * x;
	}
	*likeliest = center + (best - STEPS / 2) * step;
	*sigma = sqrt(fmax(two / sum - one / sum * one / sum, 0));
}

bool limbus_aspect(double *aspect, double *sigma, int n, const struct pose_view views[n], const struct eye *eye,
                   const struct pose_conf *conf, struct err *err)
{
	double center = conf->aspect_mean, half = REACH * conf->aspect_sigma, widest = 0;
	for (int round = 0; round < ROUNDS; round++) {
		const double step = 2 * half / (STEPS - 1);
		double cost[STEPS] = { 0 };
		struct err bad[STEPS] = { 0 };
#pragma omp parallel for schedule(dynamic)
		for (int i = 0; i < STEPS; i++)
			cost_at(&cost[i], center + (i - STEPS / 2) * step, n, views, eye, conf, &bad[i]);
		for (int i = 0; i < STEPS; i++)
			if (err_is(&bad[i])) {
				*err = bad[i];
				return false;
			}
		read_grid(&center, sigma, cost, center, step);
		// a fine grid sees no other hill
		widest = *sigma > step ? fmax(widest, *sigma) : widest;
		half = 1.5 * step;
	}
	*aspect = center;
	*sigma = fmin(fmax(*sigma, widest), conf->aspect_sigma);
	return true;
}
