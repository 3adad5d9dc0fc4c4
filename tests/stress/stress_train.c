/* What train rests on, where numbers are hard: principal components and regressions of condition numbers to 1e16, constant
 * and duplicated columns and frames, more columns than rows, values of 1e-30 and 1e30; one block of frames after another
 * against all at once; clips with frames that are not numbers. Truth: the matrices are put together from their factors.
 * Flagged: a rank below the number of columns, a clip refused, or frames told to lie outside of what was learnt. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "math/scatter/scatter.h"
#include "tests/lib/scenes/linear_clip.h"
#include "tests/lib/stress.h"

/* X[n][p] = mean + U diag(value) V^T with orthonormal U, V; U orthogonal to the ones, so that values are the singular
 * values of X centred. */
struct truth {
	int n, p, k;
	double *x, *mean, *U, *V, *value;
};

/* k orthonormal columns of n, orthogonal to the ones if centred; twice, for the digits. */
static double *orthonormal(struct rng *rng, int n, int k, bool centred)
{
	double *Q = mem_new((size_t)n * (size_t)k + 1, sizeof *Q);
	for (int c = 0; c < k; c++) {
		for (int i = 0; i < n; i++)
			Q[i * k + c] = rng_normal(rng);
		for (int pass = 0; pass < 3; pass++) {
			double sum = 0;
			for (int i = 0; i < n; i++)
				sum += Q[i * k + c] / n;
			for (int i = 0; i < n && centred; i++)
				Q[i * k + c] -= sum;
			for (int b = 0; b <= c; b++) {
				double dot = 0;
				for (int i = 0; i < n; i++)
					dot += Q[i * k + b] * Q[i * k + c];
				for (int i = 0; i < n; i++)
					Q[i * k + c] = b < c ? Q[i * k + c] - dot * Q[i * k + b] : Q[i * k + c] / sqrt(dot);
			}
		}
	}
	return Q;
}

static struct truth known_new(struct stress *s, int n, int p, double condition, double scale, double offset)
{
	struct rng *rng = &s->rng;
	int most = n - 1 < p ? n - 1 : p;
	struct truth m = { .n = n, .p = p, .k = 1 + rng_below(rng, most) };
	m.U = orthonormal(rng, n, m.k, true);
	m.V = orthonormal(rng, p, m.k, false);
	m.value = mem_new((size_t)m.k, sizeof *m.value);
	m.mean = mem_new((size_t)p, sizeof *m.mean);
	m.x = mem_new((size_t)n * (size_t)p, sizeof *m.x);
	for (int c = 0; c < m.k; c++)
		m.value[c] = scale * pow(condition, -(double)c / fmax(m.k - 1, 1));
	for (int j = 0; j < p; j++)
		m.mean[j] = scale * offset * rng_range(rng, -1, 1);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < p; j++) {
			double sum = 0;
			for (int c = m.k - 1; c >= 0; c--)
				sum += m.U[i * m.k + c] * m.value[c] * m.V[j * m.k + c];
			m.x[i * p + j] = m.mean[j] + sum;
		}
	stress_about(s, "%d rows, %d columns, rank %d, condition %.2g, scale %.2g, mean %.2g times that", n, p, m.k, condition, scale,
	             offset);
	return m;
}

static void known_free(struct truth *m)
{
	free(m->x);
	free(m->mean);
	free(m->U);
	free(m->V);
	free(m->value);
}

/* Singular values against the known ones, components orthonormal and inside the known space, none claimed beyond it. */
static void judge_components(struct stress *s, const struct truth *m, const struct scatter *sum, double digits)
{
	int k = m->n < m->p ? m->n : m->p, p = m->p;
	double *v = mem_new((size_t)p * (size_t)k, sizeof *v), *d = mem_new((size_t)k, sizeof *d);
	double *r = mem_new((size_t)p, sizeof *r);
	double size = 0;
	for (int j = 0; j < p; j++)
		size = fmax(size, fabs(m->mean[j]));
	/* Rounding of the numbers themselves moves singular values by no more than this (Weyl). */
	double top = m->value[0], tolerance = digits * top + 4 * DBL_EPSILON * (top + size) * sqrt((double)m->n * p);
	int rank = scatter_components(v, d, sum, 0, p, k);
	double worst = 0;
	for (int c = 0; c < rank; c++) {
		worst = fmax(worst, fabs(d[c] - (c < m->k ? m->value[c] : 0)));
		for (int b = 0; b <= c; b++) {
			double dot = 0;
			for (int j = 0; j < p; j++)
				dot += v[j * k + b] * v[j * k + c];
			if (!(fabs(dot - (b == c)) < 1e-12 * k))
				stress_wrong(s, "components %d and %d: product %.3g", b, c, dot);
		}
		double rest = 0;  // squared length of what is outside the known space
		for (int j = 0; j < p; j++)
			r[j] = v[j * k + c];
		for (int e = 0; e < m->k; e++) {
			double dot = 0;
			for (int j = 0; j < p; j++)
				dot += m->V[j * m->k + e] * r[j];
			for (int j = 0; j < p; j++)
				r[j] -= dot * m->V[j * m->k + e];
		}
		for (int j = 0; j < p; j++)
			rest += r[j] * r[j];
		double outside = sqrt(rest) * d[c];
		if (!(outside < 4 * tolerance))
			stress_wrong(s, "component %d of %.2g lies outside the known space by %.2g", c, d[c], outside);
	}
	for (int c = rank; c < m->k; c++)
		worst = fmax(worst, m->value[c] > 100 * tolerance ? m->value[c] : 0);
	stress_lost(s, worst / top);
	if (!(worst < tolerance))
		stress_wrong(s, "singular values off by %.2g of the largest, rank %d; tolerance %.2g", worst / top, rank, tolerance / top);
	if (rank < k)
		stress_flagged(s);
	free(v);
	free(d);
	free(r);
}

/* In blocks drawn at random. */
static void add_in_blocks(struct scatter *sum, const struct truth *m, struct rng *rng, const double *w)
{
	for (int at = 0; at < m->n;) {
		int n = 1 + rng_below(rng, m->n - at);
		scatter_add(sum, n, m->x + (size_t)at * (size_t)m->p, w ? w + at : 0);
		at += n;
	}
}

static double draw_condition(struct rng *rng)
{
	return pow(10, rng_range(rng, 0, 16));
}

static void components(struct stress *s, bool rows_kept, double scale, double offset)
{
	struct truth m = known_new(s, 2 + rng_below(&s->rng, 60), 1 + rng_below(&s->rng, 60), draw_condition(&s->rng), scale, offset);
	struct scatter sum;
	scatter_new(&sum, m.p, rows_kept ? m.n : 0);
	add_in_blocks(&sum, &m, &s->rng, 0);
	/* squared: sqrt(n eps) of the largest */
	judge_components(s, &m, &sum, rows_kept ? 1e-14 : sqrt(2 * DBL_EPSILON * (m.n + m.p)));
	scatter_free(&sum);
	known_free(&m);
}

/* Constant columns, columns and frames twice. */
static void degenerate(struct stress *s)
{
	double offset = pow(10, rng_range(&s->rng, -2, 6));
	struct truth m = known_new(s, 8 + 2 * rng_below(&s->rng, 30), 4 + rng_below(&s->rng, 40), pow(10, rng_range(&s->rng, 0, 4)),
	                           pow(10, rng_range(&s->rng, -30, 30)), offset);
	struct scatter sum, whole;
	double *w = mem_new((size_t)m.n, sizeof *w), worst = 0, top = 0;
	int p = m.p;
	for (int i = 0; i < m.n; i++) {
		double *x = m.x + i * p;
		x[0] = m.mean[0];
		x[1] = x[2];
		if (i % 2)
			memcpy(x, x - p, (size_t)p * sizeof *x);
		w[i] = i % 2 ? 0 : 2;  // each pair once, with the weight of two
	}
	scatter_new(&sum, p, 0);
	scatter_new(&whole, p, m.n);
	add_in_blocks(&sum, &m, &s->rng, 0);
	add_in_blocks(&whole, &m, &s->rng, w);
	double *a = mem_new((size_t)(p * p), sizeof *a), *b = mem_new((size_t)(p * p), sizeof *b);
	scatter_cross(a, &sum, 0, p, 0, p);
	scatter_cross(b, &whole, 0, p, 0, p);
	for (int i = 0; i < p * p; i++) {
		worst = fmax(worst, fabs(a[i] - b[i]));
		top = fmax(top, fabs(b[i]));
	}
	if (a[0] != 0)
		stress_wrong(s, "a constant column varies by %.3g", a[0]);
	stress_lost(s, worst / top);
	double rounding = DBL_EPSILON * offset;
	if (!(worst <= (1e-13 + 100 * rounding + 1000 * rounding * rounding * m.n) * top))
		stress_wrong(s, "frames twice and frames of weight 2 differ by %.2g", worst / top);
	free(a);
	free(b);
	free(w);
	scatter_free(&sum);
	scatter_free(&whole);
	known_free(&m);
}

/* Streamed in blocks against all rows at once: moments, and what follows. */
static void streamed(struct stress *s)
{
	double offset = pow(10, rng_range(&s->rng, -2, 8));
	struct truth m = known_new(s, 1000 + rng_below(&s->rng, 2500), 1 + rng_below(&s->rng, 12), pow(10, rng_range(&s->rng, 0, 6)), 1, offset);
	struct scatter sum, whole;
	int p = m.p;
	double *w = mem_new((size_t)m.n, sizeof *w), worst = 0, top = 0;
	for (int i = 0; i < m.n; i++)
		w[i] = rng_uniform(&s->rng) < 0.1 ? 0 : pow(10, rng_range(&s->rng, -3, 1));
	scatter_new(&sum, p, rng_uniform(&s->rng) < 0.5 ? 0 : 500);
	scatter_new(&whole, p, m.n);
	add_in_blocks(&sum, &m, &s->rng, w);
	scatter_add(&whole, m.n, m.x, w);
	double *a = mem_new((size_t)(p * p), sizeof *a), *b = mem_new((size_t)(p * p), sizeof *b);
	scatter_cross(a, &sum, 0, p, 0, p);
	scatter_cross(b, &whole, 0, p, 0, p);
	for (int i = 0; i < p * p; i++) {
		worst = fmax(worst, fabs(a[i] - b[i]));
		top = fmax(top, fabs(b[i]));
	}
	stress_lost(s, worst / top);
	double rounding = DBL_EPSILON * offset * sqrt(m.n);
	if (!(worst <= (1e-13 + 100 * rounding + 1000 * rounding * rounding * m.n) * top) || fabs(sum.weight / whole.weight - 1) > 1e-13)
		stress_wrong(s, "moments differ by %.2g", worst / top);
	free(a);
	free(b);
	free(w);
	scatter_free(&sum);
	scatter_free(&whole);
	known_free(&m);
}

/* y = B x + c of inputs as ill-conditioned, each in a unit of its own, some constant or twice: what is predicted for the
 * rows themselves. Directions below 1e-10 of the largest variance get nothing: 1e-5 of the spread. */
static void regression(struct stress *s, bool hostile)
{
	struct rng *rng = &s->rng;
	enum { R = 3 };
	struct truth m = known_new(s, 3 + rng_below(rng, 80), 1 + rng_below(rng, 20), draw_condition(rng), 1, 0);
	int n = m.n, q = m.p;
	double *x = m.x, *y = mem_new((size_t)(n * R), sizeof *y), *w = mem_new((size_t)n, sizeof *w), top = 0, worst = 0;
	double *unit = mem_new((size_t)q, sizeof *unit), *Gxx = mem_new((size_t)(q * q), sizeof *Gxx);
	double *Gxy = mem_new((size_t)(q * R), sizeof *Gxy), *b = mem_new((size_t)(q * R), sizeof *b), *mx = mem_new((size_t)q, sizeof *mx);
	double B[R * 20], my[R];
	for (int i = 0; i < R * q; i++)
		B[i] = rng_normal(rng);
	for (int j = 0; j < q; j++)
		unit[j] = hostile ? pow(10, rng_range(rng, -30, 30)) : 1;
	for (int i = 0; i < n; i++) {
		w[i] = 1;
		for (int j = 0; j < q; j++)
			x[i * q + j] = hostile && j % 5 == 1 ? 1 : hostile && j % 5 == 2 ? x[i * q + j - 2] : x[i * q + j];
		for (int r = 0; r < R; r++)
			for (int j = 0; j < q; j++)
				y[i * R + r] += B[r * q + j] * x[i * q + j];
		for (int j = 0; j < q; j++)
			x[i * q + j] *= unit[hostile && j % 5 == 2 ? j - 2 : j];
	}
	double weight = regress_moments(Gxx, Gxy, mx, my, n, q, R, x, y, w);
	int rank = regress(b, q, R, Gxx, Gxy, weight, mx, 0);
	for (int i = 0; i < n; i++)
		for (int r = 0; r < R; r++) {
			double sum = my[r];
			for (int j = 0; j < q; j++)
				sum += b[r * q + j] * (x[i * q + j] - mx[j]);
			worst = fmax(worst, isnan(sum) ? INFINITY : fabs(sum - y[i * R + r]));
			top = fmax(top, fabs(y[i * R + r] - my[r]));
		}
	if (rank < q)
		stress_flagged(s);
	stress_lost(s, top > 0 ? worst / top : 0);
	double size = 0;
	for (int i = 0; i < R * q; i++)
		size = fmax(size, fabs(B[i]));
	/* size, not top: outputs may cancel */
	if (!(worst <= (rank < q ? 4e-5 : 1e-9) * (size * sqrt(q) + top)))
		stress_wrong(s, "predictions off by %.2g of %.2g, rank %d of %d", worst, top, rank, q);
	free(y);
	free(w);
	free(unit);
	free(Gxx);
	free(Gxy);
	free(b);
	free(mx);
	known_free(&m);
}

/* A clip's reader, and what else happens to its frames. */
struct spoilt {
	struct train_clip clip;
	uint64_t seed;
	double share;
	bool zeros;  // numbers that the picture could hold; else such as it could not
	bool constant;
	int n_lid, n_skin;
};

static bool read_spoilt(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	static const double strange[] = { NAN, INFINITY, -INFINITY, 1e30, -1e30, 1e-30, 0 };
	static const int not_numbers = 5;
	struct spoilt *p = ctx;
	if (!p->clip.read(p->clip.ctx, first, n, lid, skin, seen, err))
		return false;
	for (long i = 0; i < n; i++) {
		struct rng rng = { p->seed + (uint64_t)(first + i) * 7919 };
		double with = strange[p->zeros ? not_numbers + rng_below(&rng, 2) : rng_below(&rng, not_numbers)];
		for (int k = 0; k < p->n_lid && p->constant; k++)
			lid[i * p->n_lid + k] = 100 + k;
		if (rng_uniform(&rng) >= p->share)
			continue;
		for (int k = 0; k < p->n_lid; k++)
			lid[i * p->n_lid + k] = with;
		for (int k = 0; k < p->n_skin; k++)
			skin[i * p->n_skin + k] = with;
	}
	return true;
}

static bool all_finite(const double *x, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (!isfinite(x[i]))
			return false;
	return true;
}

static bool is_outside(const struct skin_model *m, const double *g)
{
	double h[TRAIN_PARTS];
	skin_model_leverage(h, m, g);
	return h[TRAIN_LEFT] > SKIN_REACH || h[TRAIN_RIGHT] > SKIN_REACH || h[TRAIN_SKIN] > SKIN_REACH;
}

/* Frames that the model calls outside of what it learnt are told by a warning, and are none that it learnt from with their
 * full weight: it may not talk itself out of those. g: the inputs it was given; where one was lost it has learnt from what it
 * made of the neighbours'. *n: how many. */
static bool outside_is_right(long *n, const struct skin_model *m, const double *g, long frames, const struct train_report *r)
{
	long without = 0, told = 0;
	*n = 0;
	for (long i = 0; i < frames; i++)
		*n += is_outside(m, g + i * m->n_inputs);
	for (int p = 0; p < TRAIN_PARTS; p++)
		without += r->curve[p].n ? frames - r->used[p] + lround(r->outlying[p] * (double)frames) : 0;
	for (int i = 0; i < r->n_warnings; i++)
		told += strstr(r->warnings[i], "is a guess") != 0;
	return *n <= without && (*n == 0 || told > 0);
}

/* Predicted skin of the clip's own inputs against the clip without noise, px rms; of inputs that it says it has learnt. */
static double prediction(const struct skin_model *m, const struct linear_clip *c)
{
	int nu = 2 * m->n_vertices, n = 0;
	double *u = mem_new((size_t)nu + 1, sizeof *u), *u1 = mem_new((size_t)nu + 1, sizeof *u1), sum = 0;
	double *l = mem_new((size_t)m->n_lid, sizeof *l);
	for (long i = 0; i < c->conf.n; i += 37) {
		const double *g = c->g + i * m->n_inputs;
		if (is_outside(m, g))
			continue;
		linear_clip_truth(l, u, c, g);
		skin_model_lids(l, m, g);
		skin_model_skin(u1, 0, m, l, g + SKIN_EYE_INPUTS);
		for (int k = 0; k < nu; k++, n++)
			sum += isnan(m->u0[k]) ? 0 : (u[k] - u1[k]) * (u[k] - u1[k]);
	}
	free(l);
	free(u);
	free(u1);
	return sqrt(sum / fmax(n, 1));
}

static void clip(struct stress *s, bool zeros)
{
	struct rng *rng = &s->rng;
	struct linear_clip_conf f = { .n = 20 + rng_below(rng, 500), .n_points = 2 + rng_below(rng, 8), .n_vertices = 1 + rng_below(rng, 60),
		                          .n_au = rng_below(rng, 3), .fps = 60, .scale = pow(10, rng_range(rng, -2, 1)), .seed = rng_bits(rng) >> 20 };
	f.noise = rng_uniform(rng) < 0.3 ? 0 : pow(10, rng_range(rng, -6, 0));
	f.missing = rng_uniform(rng) < 0.5 ? 0 : rng_range(rng, 0, 0.9);
	f.repeated = rng_uniform(rng) < 0.3;
	f.no_blink = rng_uniform(rng) < 0.2;
	f.no_right = rng_uniform(rng) < 0.2;
	struct linear_clip *made = linear_clip_new(&f);
	struct spoilt spoilt = { linear_clip_train(made), f.seed, rng_uniform(rng) < 0.4 ? 0 : rng_range(rng, 0, zeros ? 0.2 : 0.5), zeros,
		                     rng_uniform(rng) < 0.1, SKIN_LIDS * f.n_points * 2, 2 * f.n_vertices };
	size_t n_g = (size_t)f.n * (size_t)(SKIN_EYE_INPUTS + f.n_au);
	double *g = mem_new(n_g, sizeof *g);
	memcpy(g, made->g, n_g * sizeof *g);
	struct train_clip given = spoilt.clip;
	given.read = read_spoilt;
	given.ctx = &spoilt;
	given.g = g;
	if (rng_uniform(rng) < 0.2)  // gaze lost here and there, for good in one eye's torsion
		for (long i = 0; i < f.n; i++)
			g[i * (SKIN_EYE_INPUTS + f.n_au) + rng_below(rng, SKIN_EYE_INPUTS)] = NAN;
	struct train_conf conf = train_defaults;
	conf.brief = rng_uniform(rng) < 0.9;
	struct skin_model m;
	struct train_report report;
	struct err err = { 0 };
	stress_about(s, "%ld frames, %d points a lid, %d vertices, noise %.2g px, %.0f %% missing, %.0f %% frames spoilt%s%s%s%s", f.n,
	             f.n_points, f.n_vertices, f.noise, 100 * f.missing, 100 * spoilt.share, spoilt.constant ? ", lids constant" : "",
	             f.repeated ? ", twice" : "", f.no_blink ? ", no blink" : "", f.no_right ? ", no right eye" : "");
	bool ok = train_run(&m, &report, &given, &conf, &err);
	if (!ok) {
		stress_flagged(s);
		if (!err_is(&err) || strchr(err.msg, '\n'))
			stress_wrong(s, "refused without a line: %s", err.msg);
	} else {
		size_t lids = (size_t)m.n_lid, skin = 2 * (size_t)m.n_vertices;
		if (!all_finite(m.K, lids * (size_t)m.n_lid_pc) || !all_finite(m.J, skin * (size_t)m.n_skin_pc)
		    || !all_finite(m.L, (size_t)m.n_lid_pc * (SKIN_EYE_INPUTS + 1))
		    || !all_finite(m.M, (size_t)m.n_skin_pc * (lids + (size_t)m.n_au + 1)))
			stress_wrong(s, "a model that is not numbers");
		else if (!f.no_right && !spoilt.constant) {
			double rms = prediction(&m, made);
			/* What it says of frames held out holds for the clip without noise too. */
			double said = f.noise + 1e-9 * 1000 * f.scale;
			for (int p = 0; p < TRAIN_PARTS; p++)
				said += report.curve[p].linear_px;
			if (isnan(rms) || isinf(rms))
				stress_wrong(s, "predictions that are not numbers");
			else if (isnan(said) && report.n_warnings)
				stress_flagged(s);  // nothing could be held out
			else
				stress_measure(s, rms / said, "times the error it states");
			long outside;
			if (!outside_is_right(&outside, &m, g, f.n, &report))
				stress_wrong(s, "%ld of %ld frames are called outside", outside, f.n);
			if (outside)
				stress_flagged(s);
			bool few = false;
			for (int i = 0; i < report.n_warnings; i++)
				few |= strstr(report.warnings[i], "frames show the skin, no more") != 0;
			if (few)
				stress_flagged(s);
			else if (rms > 10 * said)
				stress_wrong(s, "predictions off by %.2g px; it says %.2g", rms, said);
		}
	}
	skin_model_free(&m);
	train_report_free(&report);
	linear_clip_free(made);
	free(g);
}

int main(int argc, char **argv)
{
	struct stress s;
	stress_start(&s, "train", argc, argv);
	for (stress_family(&s, "components from the rows, condition to 1e16", 2000); stress_case(&s);)
		components(&s, true, 1, 0);
	for (stress_family(&s, "components from the matrix, condition to 1e16", 2000); stress_case(&s);)
		components(&s, false, 1, 0);
	for (stress_family(&s, "components, values of 1e-30 to 1e30", 2000); stress_case(&s);)
		components(&s, s.index % 2, pow(10, rng_range(&s.rng, -30, 30)), 0);
	for (stress_family(&s, "components, means to 1e8 times what varies", 2000); stress_case(&s);)
		components(&s, s.index % 2, 1, pow(10, rng_range(&s.rng, 0, 8)));
	for (stress_family(&s, "constant columns, columns and frames twice", 2000); stress_case(&s);)
		degenerate(&s);
	for (stress_family(&s, "blocks against all at once", 200); stress_case(&s);)
		streamed(&s);
	for (stress_family(&s, "regression, condition to 1e16", 10000); stress_case(&s);)
		regression(&s, false);
	for (stress_family(&s, "regression, units of 1e-30 to 1e30, columns constant and twice", 10000); stress_case(&s);)
		regression(&s, true);
	for (stress_family(&s, "clips with frames that are not numbers", 40); stress_case(&s);)
		clip(&s, false);
	for (stress_family(&s, "clips with frames of zeros", 40); stress_case(&s);)
		clip(&s, true);
	return stress_end(&s);
}
