#include "track/head/lens.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 20 };
static const double least = 0.1, most = 10, pace = 0.05, enough = 1e-4;

/* What the sights cost under a share of the perspective; NAN where they determine no pose. */
static double cost_of(double share, const double told[4][4], double away, int n, const struct head_sight *s, const struct camera *camera, double robust,
                      const struct head_prior *prior)
{
	struct camera other = *camera;
	double m[4][4];
	memcpy(m, told, sizeof m);
	other.focal_px = camera->focal_px / share;
	m[2][3] += away * (1 / share - 1);
	return isnan(head_pose_fit(m, n, s, &other, robust, prior)) ? NAN : head_pose_cost((const double(*)[4])m, n, s, &other, robust, prior);
}

double head_lens_away(const double m[4][4], int n, const struct head_sight *s)
{
	double sum = 0, weight = 0;
	for (int i = 0; i < n; i++) {
		double p[3];
		head_from(p, m, s[i].head);
		sum += s[i].weight * p[2];
		weight += s[i].weight;
	}
	return weight > 0 ? sum / weight : NAN;
}

bool head_lens_fit(struct head_lens *lens, const double cam_from_head[4][4], int n, const struct head_sight *s, const struct camera *camera, double robust,
                   const struct head_prior *prior)
{
	const double away = head_lens_away(cam_from_head, n, s);
	double x = 1, step = 1, bend = 0;
	*lens = (struct head_lens){ 0 };
	for (int i = 0; i < ROUNDS && fabs(step) > enough * x; i++) {
		const double h = pace * x, here = cost_of(x, cam_from_head, away, n, s, camera, robust, prior);
		const double less = cost_of(x - h, cam_from_head, away, n, s, camera, robust, prior), more = cost_of(x + h, cam_from_head, away, n, s, camera, robust, prior);
		bend = (less + more - 2 * here) / (h * h);
		const double slope = (more - less) / (2 * h);
		// where robust weights bend the cost the other way: downhill
		step = bend > 0 ? -slope / bend : slope > 0 ? -x : x;
		step = fmax(-0.3 * x, fmin(0.5 * x, step));
		x += step;
		if (!(x >= least && x <= most))
			return false;
	}
	// the cost is (x - share)^2 / sigma^2 and a constant
	if (!(bend > 0) || !(fabs(step) < 0.01 * x))
		return false;
	*lens = (struct head_lens){ x, sqrt(2 / bend) };
	return true;
}

void head_lens_join(struct head_lens *lens, const struct head_lens *other)
{
	const double a = pow(lens->sigma, -2), b = pow(other->sigma, -2);
	*lens = (struct head_lens){ (a * lens->share + b * other->share) / (a + b), 1 / sqrt(a + b) };
}
