#include "limbus/aspect.h"

#include <math.h>

#include "limbus/rice.h"

/* A first grid over the prior, as fine as hills are narrow near the front (a hundredth of the aspect), a finer one round its likeliest. */
enum { COARSE = 33, FINE = 11 };
static const double REACH = 4;          // sigmas
static const double FINE_REACH = 1.25;  // steps of the first grid
static const double NONE = 1e-3;        // other hills of less are not looked at

struct grid {
	int n;
	double low, step, cost[COARSE];  // minus log of the posterior
};

static double at(const struct grid *g, int i)
{
	return g->low + i * g->step;
}

/* Minus log likelihood of all photographs at a given aspect, times its prior. */
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
		const double sigma = rice_square_sigma(pose.theta, pose.theta_sigma);
		*cost += pose.cost - log1p(exp(-pose.margin)) - rice_log_evidence(pose.theta, sigma, conf->tilt_sigma);
	}
	return true;
}

static bool fill(struct grid *g, int n, const struct pose_view views[n], const struct eye *eye, const struct pose_conf *conf, struct err *err)
{
	struct err bad[COARSE] = { 0 };
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < g->n; i++)
		cost_at(&g->cost[i], at(g, i), n, views, eye, conf, &bad[i]);
	for (int i = 0; i < g->n; i++)
		if (err_is(&bad[i])) {
			*err = bad[i];
			return false;
		}
	return true;
}

static int lowest(const struct grid *g)
{
	int best = 0;
	for (int i = 1; i < g->n; i++)
		if (g->cost[i] < g->cost[best])
			best = i;
	return best;
}

/* The hill of i: down to where the next one rises, first and last point of the grid. */
static void hill(int range[2], const struct grid *g, int i)
{
	range[0] = range[1] = i;
	while (range[0] > 0 && g->cost[range[0] - 1] >= g->cost[range[0]])
		range[0]--;
	while (range[1] + 1 < g->n && g->cost[range[1] + 1] >= g->cost[range[1]])
		range[1]++;
}

/* Sum of chances within the range, relative to the likeliest's, and their standard deviation. */
static double mass(double *sigma, const struct grid *g, const int range[2], double least)
{
	double sum = 0, one = 0, two = 0;
	for (int i = range[0]; i <= range[1]; i++) {
		const double chance = exp(least - g->cost[i]), x = at(g, i) - at(g, range[0]);
		sum += chance;
		one += chance * x;
		two += chance * x * x;
	}
	*sigma = sqrt(fmax(two / sum - one / sum * one / sum, 0));
	return sum * g->step;
}

/* What stands for all that is outside of the range: its quantiles. */
static void rivals(struct aspect *a, const struct grid *g, const int range[2], double least, double outside)
{
	double sum = 0;
	for (int i = 0, k = 0; i < g->n && k < ASPECT_RIVALS; i++) {
		sum += i >= range[0] && i <= range[1] ? 0 : exp(least - g->cost[i]) * g->step;
		while (k < ASPECT_RIVALS && sum >= (k + 0.5) / ASPECT_RIVALS * outside)
			a->rival[k++] = at(g, i);
	}
}

bool limbus_aspect(struct aspect *aspect, int n, const struct pose_view views[n], const struct eye *eye, const struct pose_conf *conf,
                   struct err *err)
{
	const double half = REACH * conf->aspect_sigma;
	struct grid g = { .n = COARSE, .low = conf->aspect_mean - half, .step = 2 * half / (COARSE - 1) };
	if (!fill(&g, n, views, eye, conf, err))
		return false;
	const int best = lowest(&g), all[2] = { 0, COARSE - 1 };
	struct grid fine = { .n = FINE, .low = at(&g, best) - FINE_REACH * g.step, .step = 2 * FINE_REACH * g.step / (FINE - 1) };
	if (!fill(&fine, n, views, eye, conf, err))
		return false;
	const int finest = lowest(&fine), near[2] = { 0, FINE - 1 };
	int range[2];
	double unused, sigma, narrow;
	hill(range, &g, best);
	const double inside = mass(&sigma, &g, range, g.cost[best]), outside = mass(&unused, &g, all, g.cost[best]) - inside;
	mass(&narrow, &fine, near, fine.cost[finest]);
	// A sum over few steps sees no hill that is narrower than they are.
	*aspect = (struct aspect){ .likeliest = at(&fine, finest), .sigma = fmin(sigma > g.step ? sigma : fmax(sigma, narrow), conf->aspect_sigma) };
	aspect->elsewhere = outside > NONE * (inside + outside) ? outside / (inside + outside) : 0;
	if (aspect->elsewhere > 0)
		rivals(aspect, &g, range, g.cost[best], outside);
	return true;
}

double aspect_spread(const struct aspect *aspect)
{
	double one = 0, two = 0;
	for (int i = 0; i < ASPECT_RIVALS; i++) {
		const double x = aspect->rival[i] - aspect->likeliest;
		one += aspect->elsewhere * x / ASPECT_RIVALS;
		two += aspect->elsewhere * x * x / ASPECT_RIVALS;
	}
	return sqrt(fmax((1 - aspect->elsewhere) * aspect->sigma * aspect->sigma + two - one * one, 0));
}
