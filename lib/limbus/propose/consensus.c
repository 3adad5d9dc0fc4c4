#include "limbus/propose/consensus.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/chol.h"
#include "math/rng.h"
#include "math/stats.h"

enum { N = ELLIPSE_N, TRIES = 140, POLISH = 8, MIN_ARCS = 40, C = EDGE_CANDIDATES, STRIDE = 4 };

static const double ARC_NATS = 0.15;  // log likelihood of one arc that agrees: neighbours err together

struct arcs {
	int n;
	double row[ARCS][N], d[ARCS][C], weight[ARCS][C];
	int count[ARCS];
};

static void collect(struct arcs *arcs, const struct ring *r, const struct grey *tint, double half)
{
	double strength[ARCS][C], first[ARCS];
	int at[ARCS];
	arcs->n = 0;
	for (int i = 0; i < ARCS; i++) {
		int n = arcs->n;
		if (!r->inside[i] || !(arcs->count[n] = edge_candidates(arcs->d[n], strength[n], r, i, half)))
			continue;
		ellipse_shift_along(arcs->row[n], r->normal[i], &r->e, r->t[i]);
		first[n] = strength[n][0];
		at[n] = i;
		arcs->n++;
	}
	double typical = stats_quantile(arcs->n, first, 0.6);
	for (int i = 0; i < arcs->n; i++)
		for (int j = 0; j < arcs->count[i]; j++) {
			double s = arcs->d[i][j] + half, x = r->p[at[i]][0] + s * r->normal[at[i]][0];
			double white = tint ? grey_at(tint, x, r->p[at[i]][1] + s * r->normal[at[i]][1]) : 1;
			arcs->weight[i][j] = fmin(strength[i][j] / typical, 1) * white * white;
		}
}

/* What is known before, as a change of q from the start. */
struct weak {
	double q[N], precision[N];  // px, px^-2
};

static struct weak weak_of(const struct ellipse_prior *known, const struct ellipse *e)
{
	struct weak w;
	ellipse_to_q(w.q, e);
	for (int a = 0; a < N; a++) {
		w.q[a] = known->q[a] - w.q[a];
		w.precision[a] = 1 / (known->sigma[a] * known->sigma[a]);
	}
	return w;
}

/* Its log likelihood against dq, in units of arcs' support. */
static double against(const struct weak *w, const double dq[N])
{
	double sum = 0;
	for (int a = 0; a < N; a++)
		sum += 0.5 * w->precision[a] * (dq[a] - w->q[a]) * (dq[a] - w->q[a]);
	return sum / (STRIDE * ARC_NATS);
}

static double shift(const double row[N], const double dq[N])
{
	double s = 0;
	for (int a = 0; a < N; a++)
		s += row[a] * dq[a];
	return s;
}

/* The candidate of an arc nearest the hypothesis; its residual, and its weight (0 beyond tol). */
static double nearest(double *residual, const struct arcs *arcs, int i, double at, double tol)
{
	double best = 0;
	for (int j = 0; j < arcs->count[i]; j++) {
		double res = arcs->d[i][j] - at, z = res / tol;
		double w = fabs(z) < 1 ? arcs->weight[i][j] * (1 - z * z) * (1 - z * z) : 0;
		if (w > best) {
			best = w;
			*residual = res;
		}
	}
	return best;
}

static double support(const struct arcs *arcs, const double dq[N], double tol, int stride)
{
	double sum = 0, res;
	for (int i = 0; i < arcs->n; i += stride)
		sum += nearest(&res, arcs, i, shift(arcs->row[i], dq), tol);
	return sum;
}

/* One arc from each fifth of the ring, one of its candidates, and the change of q that meets them, drawn a little
 * towards no change: five arcs on one side say little of the other. */
static bool hypothesis(double dq[N], const struct arcs *arcs, struct rng *rng, double range, const struct weak *weak)
{
	double h[N][N] = { 0 };
	for (int a = 0; a < N; a++)
		dq[a] = 0;
	for (int k = 0; k < N; k++) {
		int i = (int)((k + rng_uniform(rng)) * arcs->n / N) % arcs->n, j = rng_below(rng, arcs->count[i]);
		for (int a = 0; a < N; a++) {
			dq[a] += arcs->row[i][a] * arcs->d[i][j];
			for (int b = 0; b < N; b++)
				h[a][b] += arcs->row[i][a] * arcs->row[i][b];
		}
	}
	for (int a = 0; a < N; a++)
		h[a][a] += 0.01;
	for (int a = 0; a < N; a++) {
		const double precision = range * range / 36 * weak->precision[a];
		h[a][a] += precision;
		dq[a] += precision * weak->q[a];
	}
	if (!chol_solve(N, N, &h[0][0], dq))
		return false;
	for (int a = 0; a < N; a++)
		if (!(fabs(dq[a]) < 1.2 * range))
			return false;
	return true;
}

static void polish(double dq[N], const struct arcs *arcs, double tol, const struct weak *weak)
{
	for (int it = 0; it < POLISH; it++) {
		double h[N][N] = { 0 }, g[N] = { 0 };
		for (int i = 0; i < arcs->n; i++) {
			double res = 0, w = nearest(&res, arcs, i, shift(arcs->row[i], dq), tol);
			for (int a = 0; a < N; a++) {
				g[a] += w * arcs->row[i][a] * res;
				for (int b = 0; b < N; b++)
					h[a][b] += w * arcs->row[i][a] * arcs->row[i][b];
			}
		}
		for (int a = 0; a < N; a++)
			h[a][a] += 1e-3;
		for (int a = 0; a < N; a++) {
			const double precision = tol * tol / 4 / ARC_NATS * weak->precision[a];
			h[a][a] += precision;
			g[a] += precision * (weak->q[a] - dq[a]);
		}
		if (!chol_solve(N, N, &h[0][0], g))
			return;
		for (int a = 0; a < N; a++)
			dq[a] += g[a];
	}
}

bool rim_consensus(struct ellipse *e, const struct grey *grey, const struct grey *tint, double range,
                   const struct ellipse_prior *known, int width, int height)
{
	struct ring r = ring_sample(grey, e, -1.3 * range, 1.3 * range, fmax(grey->scale, range / 30), 3, width, height);
	struct arcs arcs;
	collect(&arcs, &r, tint, range / 4);
	ring_free(&r);
	struct weak weak = { 0 };
	if (known)
		weak = weak_of(known, e);
	if (arcs.n < (known ? N : MIN_ARCS))
		return false;
	struct rng rng = { 0x11b5 };
	const double tol = fmax(range / 6, 2 * grey->scale);
	double best[N] = { 0 }, score = support(&arcs, best, tol, STRIDE) - against(&weak, best), q[N];
	for (int s = 0; s < TRIES; s++) {
		double dq[N];
		if (!hypothesis(dq, &arcs, &rng, range, &weak))
			continue;
		double now = support(&arcs, dq, tol, STRIDE) - against(&weak, dq);
		if (now > score) {
			score = now;
			memcpy(best, dq, sizeof best);
		}
	}
	polish(best, &arcs, tol, &weak);
	polish(best, &arcs, 0.6 * tol, &weak);
	ellipse_to_q(q, e);
	for (int a = 0; a < N; a++)
		q[a] += best[a];
	struct ellipse f;
	if (!ellipse_from_q(&f, q) || f.b < 0.5 * f.a)
		return false;
	*e = f;
	return true;
}
