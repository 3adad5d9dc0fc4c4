#include <math.h>
#include <string.h>

#include "anatomy/fit.h"
#include "limbus/ramp.h"
#include "math/chol.h"

/* Arcs whose widths err together: streaks of the iris, veins of the sclera. */
static const double ALIKE_ARCS = 10;
static const double SCATTER = 0.05;  // of log width²: no limbus is more regular
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

enum { BASIS = 4 };  // blur², and the ramp's own width² with a second harmonic: wider above and below than at the sides

/* Non-negative in its first two terms, by dropping one of them. */
static void solve(double x[BASIS], const double h[BASIS][BASIS], const double g[BASIS])
{
	for (int skip = -1; skip < 2; skip++) {
		double m[BASIS][BASIS];
		memcpy(m, h, sizeof m);
		memcpy(x, g, BASIS * sizeof *x);
		for (int i = 0; i < BASIS; i++) {
			m[i][i] *= 1 + 1e-9;
			if (i >= 2)
				m[i][i] += 3 * h[1][1];  // harmonics are small
			if (i == skip || (skip == 1 && i >= 2)) {
				for (int j = 0; j < BASIS; j++)
					m[i][j] = m[j][i] = 0;
				m[i][i] = 1;
				x[i] = 0;
			}
		}
		if (chol_solve(BASIS, BASIS, &m[0][0], x) && x[0] >= 0 && x[1] >= 0)
			return;
	}
}

double ramp_cost(const struct pose_view *view, const double cam_from_eye[4][4], const struct eye *eye)
{
	struct fit fit = { .camera = view->camera };
	struct cornea cornea = eye_cornea(eye);
	double basis[POSE_RAMP][BASIS], w2[POSE_RAMP], ss = 0, x[BASIS] = { 0 };
	int n = 0;
	memcpy(fit.cam_from_eye, cam_from_eye, sizeof fit.cam_from_eye);
	for (int i = 0; i < POSE_RAMP; i++) {
		if (!(view->ramp[i] > 0))
			continue;
		double p[2], normal[2], g, t = 2 * M_PI * i / POSE_RAMP, phi = view->limbus.angle + t;
		ellipse_point(p, normal, &view->limbus, t);
		g = slope_width(&fit, &cornea, p, normal, eye);
		basis[n][0] = 1;
		basis[n][1] = g * g;
		basis[n][2] = g * g * cos(2 * phi);
		basis[n][3] = g * g * sin(2 * phi);
		w2[n++] = view->ramp[i] * view->ramp[i];
	}
	for (int round = 0; round < 8; round++) {
		double h[BASIS][BASIS] = { 0 }, u[BASIS] = { 0 };
		ss = 0;
		for (int i = 0; i < n; i++) {
			double model = 0;
			for (int a = 0; a < BASIS; a++)
				model += x[a] * basis[i][a];
			/* relative errors; widths far off the model are streaks and lids */
			double z = round ? log(w2[i] / fmax(model, 0.04 * w2[i])) : 0;
			double weight = 1 / ((round ? fmax(model * model, 1e-3 * w2[i] * w2[i]) : 1) * (1 + z * z / 0.04));
			ss += fmin(z * z, 0.36) / n;
			for (int a = 0; a < BASIS; a++) {
				u[a] += weight * basis[i][a] * w2[i];
				for (int b = 0; b < BASIS; b++)
					h[a][b] += weight * basis[i][a] * basis[i][b];
			}
		}
		solve(x, h, u);
	}
	return n ? 0.5 * n / ALIKE_ARCS * log(ss + SCATTER * SCATTER) : 0;
}
