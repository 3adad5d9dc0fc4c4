/* The eye's pose from one ellipse, from the front to the side, near and far, at the picture's edge: against the Cramér-Rao bound,
 * which for five numbers out of five is the noise of the ellipse through the inverse of its Jacobian. An ellipse has two poses; the
 * one next to the truth is judged. Flagged: refused, so near the front that the noise hides the tilt, or reported with a sigma
 * that covers the error. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/stress.h"
#include "tests/peers/ellipse_bound.h"

static const double BEST = 1e-5;  // noise of the best ellipses, of their size
enum { N = ELLIPSE_N, POINTS = 60, DRAWS = 40 };
typedef long double real;

/* tilt: the axis, x and y of a unit vector, against the direction to the camera; centre of the limbus in the camera, mm. */
struct seen {
	double tilt[2], at[3], focal, radius;
};

/* The axis out of the eye, and the limbus' two directions, in the camera's frame. */
static void directions(real axis[3], real u[3], real v[3], const struct seen *s)
{
	real to[3], length = sqrtl((real)s->at[0] * s->at[0] + (real)s->at[1] * s->at[1] + (real)s->at[2] * s->at[2]), e1[3], e2[3], n;
	for (int k = 0; k < 3; k++)
		to[k] = -(real)s->at[k] / length;
	// Any frame across the line of sight that moves smoothly with it.
	n = sqrtl(to[1] * to[1] + to[2] * to[2]);
	e1[0] = n;
	e1[1] = -to[0] * to[1] / n;
	e1[2] = -to[0] * to[2] / n;
	e2[0] = to[1] * e1[2] - to[2] * e1[1];
	e2[1] = to[2] * e1[0] - to[0] * e1[2];
	e2[2] = to[0] * e1[1] - to[1] * e1[0];
	real a = s->tilt[0], b = s->tilt[1], c = sqrtl(1 - a * a - b * b);
	for (int k = 0; k < 3; k++) {
		axis[k] = a * e1[k] + b * e2[k] + c * to[k];
		u[k] = e1[k];
	}
	real along = u[0] * axis[0] + u[1] * axis[1] + u[2] * axis[2];
	for (int k = 0; k < 3; k++)
		u[k] -= along * axis[k];
	n = sqrtl(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
	for (int k = 0; k < 3; k++)
		u[k] /= n;
	v[0] = axis[1] * u[2] - axis[2] * u[1];
	v[1] = axis[2] * u[0] - axis[0] * u[2];
	v[2] = axis[0] * u[1] - axis[1] * u[0];
}

/* The picture of the circle, as q: the conic of its homography, its centre and its square root in closed form. */
static void project(real q[N], const struct seen *s)
{
	real axis[3], m[3][3], inv[3][3], g[3][3];
	real u[3], v[3];
	directions(axis, u, v, s);
	for (int i = 0; i < 3; i++) {
		real f = i < 2 ? s->focal : 1;
		m[i][0] = f * s->radius * u[i];
		m[i][1] = f * s->radius * v[i];
		m[i][2] = f * (real)s->at[i];
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
			inv[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
		}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			g[i][j] = inv[0][i] * inv[0][j] + inv[1][i] * inv[1][j] - inv[2][i] * inv[2][j];
	// x' A x + 2 b' x + c = 0; S^2 = level A^-1, and r, e, f are S's (math/ellipse.h).
	real det = g[0][0] * g[1][1] - g[0][1] * g[0][1];
	q[0] = (g[0][1] * g[1][2] - g[1][1] * g[0][2]) / det;
	q[1] = (g[0][1] * g[0][2] - g[0][0] * g[1][2]) / det;
	real level = -(g[0][2] * q[0] + g[1][2] * q[1] + g[2][2]);
	real xx = level * g[1][1] / det, yy = level * g[0][0] / det, xy = -level * g[0][1] / det;
	real root = sqrtl(xx * yy - xy * xy), trace = sqrtl(xx + yy + 2 * root);
	q[2] = trace / 2;
	q[3] = (xx - yy) / (2 * trace);
	q[4] = xy / trace;
}

/* Cholesky's factor. False: not positive definite. */
static bool factor(double L[N][N], double C[N][N])
{
	memset(L, 0, sizeof(double[N][N]));
	for (int j = 0; j < N; j++)
		for (int i = j; i < N; i++) {
			double v = C[i][j];
			for (int k = 0; k < j; k++)
				v -= L[i][k] * L[j][k];
			if (i == j && !(v > 0))
				return false;
			L[i][j] = i == j ? sqrt(v) : v / L[j][j];
		}
	return true;
}

/* Standard deviation of the axis' direction that the ellipse's noise L leaves: rms over its two tilts. INFINITY: none. */
static double bound_of(const struct seen *s, double L[N][N])
{
	double J[N][N], work[N][2 * N], sum = 0;
	for (int p = 0; p < N; p++) {
		struct seen up = *s, down = *s;
		double *a = p < 2 ? &up.tilt[p] : &up.at[p - 2], *b = p < 2 ? &down.tilt[p] : &down.at[p - 2], h = p < 2 ? 1e-7 : 1e-6 * s->at[2];
		real hi[N], lo[N];
		*a += h;
		*b -= h;
		project(hi, &up);
		project(lo, &down);
		for (int i = 0; i < N; i++)
			J[i][p] = (double)((hi[i] - lo[i]) / (2 * (real)h));
	}
	for (int i = 0; i < N; i++)  // J X = L: the parameters' deviations for each independent piece of noise
		for (int j = 0; j < N; j++) {
			double unit = j < 2 ? 1 : s->at[2];
			work[i][j] = J[i][j] * unit;
			work[i][N + j] = L[i][j];
		}
	for (int c = 0; c < N; c++) {
		int top = c;
		for (int i = c; i < N; i++)
			top = fabs(work[i][c]) > fabs(work[top][c]) ? i : top;
		if (!(fabs(work[top][c]) > 0))
			return INFINITY;
		for (int j = 0; j < 2 * N; j++) {
			double t = work[c][j];
			work[c][j] = work[top][j];
			work[top][j] = t;
		}
		for (int i = 0; i < N; i++) {
			double f = i == c ? 0 : work[i][c] / work[c][c];
			for (int j = c; j < 2 * N && f != 0; j++)
				work[i][j] -= f * work[c][j];
		}
	}
	// As an angle: towards and away from the camera the unit vector's part across it moves by the cosine alone.
	double across = hypot(s->tilt[0], s->tilt[1]), cosine = sqrt(1 - across * across);
	for (int j = 0; j < N; j++) {
		double d[2] = { work[0][N + j] / work[0][0], work[1][N + j] / work[1][1] };
		double radial = across > 0 ? (d[0] * s->tilt[0] + d[1] * s->tilt[1]) / across : d[0];
		sum += d[0] * d[0] + d[1] * d[1] - radial * radial + pow(radial / cosine, 2);
	}
	return sqrt(sum);
}

static struct seen draw(struct rng *rng, double theta, bool wide)
{
	struct seen s = { .focal = pow(10, rng_range(rng, 3, 4.3)), .radius = rng_range(rng, 5, 7) };
	double phi = rng_range(rng, 0, 2 * M_PI), size = pow(10, rng_range(rng, 1, wide ? 2.7 : 2.3));
	s.tilt[0] = sin(theta) * cos(phi);
	s.tilt[1] = sin(theta) * sin(phi);
	s.at[2] = fmax(s.focal * s.radius / size, 30);
	for (int k = 0; k < 2; k++)
		s.at[k] = (wide ? 0.4 : 0.05) * s.at[2] * rng_range(rng, -1, 1);
	return s;
}

/* Angle between the truth's axis and the nearer of the two found, and that one's angle from the direction to the camera. */
static double off(const struct pose *pose, const struct seen *s)
{
	real axis[3], u[3], v[3];
	double best = INFINITY;
	directions(axis, u, v, s);
	for (int other = 0; other < 2 && (!other || isfinite(pose->margin)); other++) {
		const double(*m)[4] = other ? pose->other_cam_from_eye : pose->cam_from_eye;
		double d = 0;
		for (int k = 0; k < 3; k++)
			d += pow(-m[k][2] - (double)axis[k], 2);
		best = fmin(best, 2 * asin(fmin(sqrt(d) / 2, 1)));
	}
	return best;
}

static bool solve(struct pose *pose, const struct seen *s, const double q[N], double C[N][N])
{
	struct pose_view view = { .camera = { .focal_px = s->focal, .source = CAMERA_CONF } };
	struct eye eye = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = s->radius, .limbus_aspect = 1, .iris_depth = 3.3 };
	struct err err = { 0 };
	memcpy(view.cov_q, C, sizeof view.cov_q);
	return ellipse_from_q(&view.limbus, q) && limbus_pose(pose, &view, &eye, &pose_defaults, &err);
}

/* Of points round the ellipse with noise sigma px. */
static bool noise_of(double C[N][N], double L[N][N], const struct ellipse *e, double sigma)
{
	double t[POINTS];
	for (int i = 0; i < POINTS; i++)
		t[i] = 2 * M_PI * (i + 0.5) / POINTS;
	return ellipse_bound(C, e, POINTS, t, sigma) && factor(L, C);
}

static void one(struct stress *run, double theta, double sigma, bool wide)
{
	struct seen s = draw(&run->rng, theta, wide);
	real exact[N];
	double q[N], C[N][N], L[N][N], sum = 0, own = 0;
	struct ellipse e;
	int n = 0, draws = sigma > 0 ? DRAWS : 1;
	project(exact, &s);
	for (int i = 0; i < N; i++)
		q[i] = (double)exact[i];
	stress_about(run, "theta %.4g deg, focal %.0f px, %.0f mm away, %.1f mm aside, ellipse of %.1f px, noise %.2g of it", theta * 180 / M_PI, s.focal, s.at[2],
	             hypot(s.at[0], s.at[1]), q[2], sigma);
	// Exact ellipses are said to be as good as the best that are measured.
	double px = (sigma > 0 ? sigma : BEST) * q[2];
	if (!ellipse_from_q(&e, q) || !noise_of(C, L, &e, px)) {
		stress_flagged(run);
		return;
	}
	double bound = bound_of(&s, L), hidden = 0.3 * sin(theta);
	for (int d = 0; d < draws; d++) {
		double drawn[N];
		struct pose pose;
		memcpy(drawn, q, sizeof drawn);
		for (int i = 0; i < N && sigma > 0; i++) {
			double z = rng_normal(&run->rng);
			for (int k = i; k < N; k++)
				drawn[k] += L[k][i] * z;
		}
		if (!solve(&pose, &s, drawn, C)) {
			stress_flagged(run);
			continue;
		}
		double wrong = off(&pose, &s);
		if (!isfinite(wrong + pose.theta_sigma + pose.theta)) {
			stress_wrong(run, "not numbers: off by %g, sigma %g", wrong, pose.theta_sigma);
			return;
		}
		sum += wrong * wrong;
		own += pose.theta_sigma * pose.theta_sigma;
		n++;
	}
	if (!(bound < hidden) || !n) {
		stress_flagged(run);
		return;
	}
	double rms = sqrt(sum / n), ratio = rms / bound;
	if (sigma > 0) {
		stress_measure(run, ratio, "times the bound");
		// 2 DRAWS numbers: the ratio's own deviation is 0.08; a bent way from ellipse to tilt adds to it.
		if (ratio < 0.65)
			stress_wrong(run, "better than the bound: %.3f of it", ratio);
		if (ratio > 1.5 && rms > 1.5 * sqrt(own / n))
			stress_wrong(run, "%.3g times the bound, its own sigma %.3g of the error", ratio, sqrt(own / n) / rms);
	} else {
		stress_lost(run, rms);
		if (rms > 0.02 * bound)
			stress_wrong(run, "the axis is off by %.2g rad; noise of a hundred thousandth would explain %.2g", rms, bound);
	}
}

int main(int argc, char **argv)
{
	struct stress s;
	stress_start(&s, "pose", argc, argv);
	for (stress_family(&s, "exact ellipses, b/a of 1 - 1e-12 to 1 - 1e-3", 2000); stress_case(&s);)
		one(&s, sqrt(2 * pow(10, rng_range(&s.rng, -12, -3))), 0, false);
	for (stress_family(&s, "exact ellipses, b/a of 0.999 to 0.25", 2000); stress_case(&s);)
		one(&s, rng_range(&s.rng, 0.045, 1.3), 0, false);
	for (stress_family(&s, "exact ellipses, close up and at the picture's edge", 2000); stress_case(&s);)
		one(&s, rng_range(&s.rng, 0.045, 0.8), 0, true);
	for (stress_family(&s, "noise, to 45 degrees", 200); stress_case(&s);)
		one(&s, rng_range(&s.rng, 0.02, 0.8), pow(10, rng_range(&s.rng, -5, -2)), false);
	for (stress_family(&s, "noise, 45 to 70 degrees", 200); stress_case(&s);)
		one(&s, rng_range(&s.rng, 0.8, 1.2), pow(10, rng_range(&s.rng, -5, -2.5)), false);
	for (stress_family(&s, "noise, near the front", 200); stress_case(&s);)
		one(&s, pow(10, rng_range(&s.rng, -6, -1.3)), pow(10, rng_range(&s.rng, -5, -2)), false);
	return stress_end(&s);
}
