#include <math.h>
#include <string.h>

#include "eye/limbus_lean.h"
#include "math/stats.h"

/* Arcs whose widths err together: streaks of the iris, veins of the sclera. */
static const double ALIKE_ARCS = 10;
static const double STEP = 0.01;  // of the limbus radius

/* Width in the picture, along the limbus' normal, of 1 mm of radius on the cornea's slope. 0: not seen. */
static double slope_width(const struct fit *fit, const struct cornea *cornea, const double px[2], const double normal[2],
                          const struct eye *eye)
{
	double origin[3], dir[3], at[2][2];
	const double depth = eye_limbus_depth(eye), r = eye->limbus_radius;
	fit_ray(origin, dir, fit, px);
	double t = (depth - origin[2]) / dir[2], x = origin[0] + t * dir[0], y = origin[1] + t * dir[1], n = hypot(x, y);
	if (!(n > 0))
		return 0;
	for (int i = 0; i < 2; i++) {
		double s = r * (1 + (i ? STEP : -STEP)), P[3] = { s * x / n, s * y / n, cornea_depth(cornea, s) };
		if (!fit_project(at[i], fit, P))
			return 0;
	}
	double w = ((at[1][0] - at[0][0]) * normal[0] + (at[1][1] - at[0][1]) * normal[1]) / (2 * STEP * r);
	return fmax(w, 0);
}

/* Mean clipped square of log(own width / model); model² = blur² + (ramp g)², both at least 0, by weighted squares. */
static double unexplained(const struct rim *limbus, const double g[ARCS])
{
	double blur2 = 0, ramp2 = 0, d[ARCS], ss = 0;
	int n = 0;
	for (int round = 0; round < 8; round++) {
		double a = 0, b = 0, c = 0, u = 0, v = 0;
		for (int i = 0; i < ARCS; i++) {
			if (!limbus->used[i] || !(limbus->own_width[i] > 0))
				continue;
			double w2 = limbus->own_width[i] * limbus->own_width[i], x = g[i] * g[i];
			double model = blur2 + ramp2 * x, weight = round ? 1 / (model * model) : 1;
			/* widths far off the model are streaks and lids */
			double z = round ? log(w2 / model) : 0;
			weight /= 1 + z * z / 0.04;
			a += weight;
			b += weight * x;
			c += weight * x * x;
			u += weight * w2;
			v += weight * w2 * x;
		}
		double det = a * c - b * b;
		ramp2 = det > 0 ? (a * v - b * u) / det : 0;
		blur2 = det > 0 ? (c * u - b * v) / det : 0;
		if (!(blur2 > 0)) {
			blur2 = 0;
			ramp2 = c > 0 ? v / c : 0;
		}
		if (!(ramp2 > 0)) {
			ramp2 = 0;
			blur2 = a > 0 ? u / a : 0;
		}
	}
	for (int i = 0; i < ARCS; i++)
		if (limbus->used[i] && limbus->own_width[i] > 0) {
			double model = blur2 + ramp2 * g[i] * g[i];
			double z = model > 0 ? log(limbus->own_width[i] * limbus->own_width[i] / model) : 0;
			d[n++] = fmin(fabs(z), 0.6);
		}
	for (int i = 0; i < n; i++)
		ss += d[i] * d[i] / n;
	return n ? ss : INFINITY;
}

double lean_ramp(const struct rim *limbus, const struct camera *camera, const double a[4][4], const double b[4][4],
                 const struct eye *eye)
{
	struct fit fit = { .camera = *camera };
	struct cornea cornea = eye_cornea(eye);
	double ss[2], g[ARCS];
	int n = 0;
	for (int h = 0; h < 2; h++) {
		memcpy(fit.cam_from_eye, h ? b : a, sizeof fit.cam_from_eye);
		for (int i = 0; i < ARCS; i++)
			g[i] = slope_width(&fit, &cornea, limbus->p[i], limbus->normal[i], eye);
		ss[h] = unexplained(limbus, g);
	}
	for (int i = 0; i < ARCS; i++)
		n += limbus->used[i];
	if (!(ss[0] > 0) || !(ss[1] > 0) || !isfinite(ss[0] + ss[1]))
		return 0;
	return 0.5 * n / ALIKE_ARCS * log(ss[1] / ss[0]);
}
