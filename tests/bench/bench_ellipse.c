/* Ellipse fits on synthetic edge points: error against the Cramér-Rao bound, and time. ANCHORS' case: N = 360,
 * sigma 0.2 px, semi-axes 100 and 90 px, 30 % hidden. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bridge/cv_ellipse.h"
#include "math/ellipse_fit.h"
#include "math/rng.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/peers/ellipse_bound.h"

enum { POINTS = 360, METHODS = 6 };
static const struct ellipse TRUTH = { 320.3, 239.1, 100, 90, 0.6 };
static const double SIGMA = 0.2;
static const char *const names[METHODS] = { "ours: Tukey, geometric", "Halir-Flusser", "OpenCV fitEllipse",
	"OpenCV fitEllipseAMS", "OpenCV fitEllipseDirect", "RANSAC, 100 rounds" };

static void points(struct rng *rng, double p[POINTS][2], double t[POINTS], double outliers)
{
	for (int i = 0; i < POINTS; i++) {
		double n[2];
		t[i] = 2 * M_PI * 0.7 * i / POINTS;
		ellipse_point(p[i], n, &TRUTH, t[i]);
		double d = rng_uniform(rng) < outliers ? rng_range(rng, -20, 20) : SIGMA * rng_normal(rng);
		p[i][0] += d * n[0];
		p[i][1] += d * n[1];
	}
}

/* Five points, inliers within 3 sigma, refit to them by least squares. */
static bool ransac(struct ellipse *e, const double p[POINTS][2], struct rng *rng)
{
	double best = 0, in[POINTS][2], t;
	for (int r = 0; r < 100; r++) {
		double five[5][2];
		struct ellipse f;
		for (int i = 0; i < 5; i++)
			memcpy(five[i], p[rng_below(rng, POINTS)], sizeof five[i]);
		if (!ellipse_fit_direct(&f, 5, five, 0))
			continue;
		int n = 0;
		for (int i = 0; i < POINTS; i++)
			n += fabs(ellipse_distance(&t, &f, p[i])) < 3 * SIGMA;
		if (n > best) {
			best = n;
			*e = f;
		}
	}
	int n = 0;
	for (int i = 0; i < POINTS && best > 0; i++)
		if (fabs(ellipse_distance(&t, e, p[i])) < 3 * SIGMA)
			memcpy(in[n++], p[i], sizeof in[0]);
	return ellipse_fit_direct(e, n, in, 0);
}

static bool fit(int method, struct ellipse *e, const double p[POINTS][2], struct rng *rng)
{
	struct ellipse_fit info;
	switch (method) {
	case 0: return ellipse_fit_robust(e, &info, POINTS, p, 0, 0, 0, false);
	case 1: return ellipse_fit_direct(e, POINTS, p, 0);
	case 2: return cv_ellipse_fit(e, POINTS, &p[0][0], CV_ELLIPSE_LS);
	case 3: return cv_ellipse_fit(e, POINTS, &p[0][0], CV_ELLIPSE_AMS);
	case 4: return cv_ellipse_fit(e, POINTS, &p[0][0], CV_ELLIPSE_DIRECT);
	default: return ransac(e, p, rng);
	}
}

struct job {
	int method;
	double p[POINTS][2];
	struct rng rng;
};

static void run(void *ctx)
{
	struct job *job = ctx;
	struct ellipse e;
	fit(job->method, &e, job->p, &job->rng);
}

/* Worst of the five parameters' root mean square errors over the bound of the clean points. */
static double against_bound(int method, double outliers, int cases)
{
	struct rng rng = { 11 };
	double ss[ELLIPSE_N] = { 0 }, p[POINTS][2], t[POINTS], bound[ELLIPSE_N][ELLIPSE_N], worst = 0;
	for (int c = 0; c < cases; c++) {
		double q[ELLIPSE_N], q0[ELLIPSE_N];
		struct ellipse e = TRUTH;
		points(&rng, p, t, outliers);
		if (!fit(method, &e, p, &rng))
			e.a = e.b = 1;
		ellipse_to_q(q, &e);
		ellipse_to_q(q0, &TRUTH);
		for (int i = 0; i < ELLIPSE_N; i++)
			ss[i] += (q[i] - q0[i]) * (q[i] - q0[i]) / cases;
	}
	ellipse_bound(bound, &TRUTH, POINTS, t, SIGMA);
	for (int i = 0; i < ELLIPSE_N; i++)
		worst = fmax(worst, sqrt(ss[i] / (bound[i][i] / (1 - outliers))));
	return worst;
}

int main(int argc, char **argv)
{
	static const double share[] = { 0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5 };
	bench_open("ellipse", argc, argv);
	const int cases = bench_quick() ? 30 : 400, ours = bench_quick() ? 400 : 1200;  // so many cases determine the bar's ratio to 5 %
	double worst = 0;
	struct job job = { .rng = { 5 } };
	double t[POINTS];
	for (int s = 0; s < (int)(sizeof share / sizeof *share); s += bench_quick() ? 2 : 1) {
		struct rng rng = { 17 };
		points(&rng, job.p, t, share[s]);
		for (int m = 0; m < METHODS; m++) {
			char setting[32];
			snprintf(setting, sizeof setting, "%.0f %% outliers", 100 * share[s]);
			job.method = m;
			double ratio = against_bound(m, share[s], m == 0 ? ours : cases);
			if (m == 0 && share[s] <= 0.3)
				worst = fmax(worst, ratio);
			bench_row("ellipse fits", names[m], setting, bench_time(run, &job, bench_quick() ? 5 : 15), "fit", ratio,
			          "x bound", "worst parameter, rms");
		}
	}
	bench_goal("ellipse from edge points, to 30 % outliers", "<= 1.1 x the Cramer-Rao bound", worst, "x", worst <= 1.1);
	return bench_close();
}
