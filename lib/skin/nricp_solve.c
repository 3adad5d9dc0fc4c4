#include "skin/nricp_solve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"
#include "math/spd.h"

typedef double four[4];

struct nricp_solver {
	const struct nricp_graph *graph;
	int steps;
	double tolerance;
	four *b, *r, *z, *p, *q;
	double (*inverse)[6];  // of the diagonal blocks
	struct spd *spd;       // the direct way: 3 n rows
	int32_t *start;
	double *value;
};

/* Rows of the full system: R's pattern, each entry a block of three. */
static void expand(struct nricp_solver *s)
{
	const struct nricp_graph *g = s->graph;
	size_t n = (size_t)g->n, entries = 9 * (size_t)g->r_start[n];
	int32_t *column = mem_array(entries + 1, sizeof *column), at = 0;
	s->start = mem_array(3 * n + 1, sizeof *s->start);
	s->value = mem_array(entries + 1, sizeof *s->value);
	for (int i = 0; i < 3 * g->n; i++) {
		s->start[i] = at;
		for (int32_t e = g->r_start[i / 3]; e < g->r_start[i / 3 + 1]; e++)
			for (int c = 0; c < 3; c++)
				if (e == g->r_start[i / 3] || c == i % 3)
					column[at++] = 3 * g->r_column[e] + c;
	}
	s->start[3 * n] = at;
	s->spd = spd_new(3 * g->n, s->start, column);
	free(column);
}

struct nricp_solver *nricp_solver_new(const struct nricp_graph *graph, bool direct, int steps, double tolerance)
{
	struct nricp_solver *s = mem_new(1, sizeof *s);
	size_t n = (size_t)graph->n + 1;
	s->graph = graph;
	s->steps = steps;
	s->tolerance = tolerance;
	s->b = mem_array(n, sizeof *s->b);
	s->r = mem_array(n, sizeof *s->r);
	s->z = mem_array(n, sizeof *s->z);
	s->p = mem_array(n, sizeof *s->p);
	s->q = mem_array(n, sizeof *s->q);
	s->inverse = mem_array(n, sizeof *s->inverse);
	if (direct)
		expand(s);
	return s;
}

void nricp_solver_free(struct nricp_solver *s)
{
	if (!s)
		return;
	void *const all[] = { s->b, s->r, s->z, s->p, s->q, s->inverse, s->start, s->value };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	spd_free(s->spd);
	free(s);
}

SIMD_INLINE void block_times(double out[4], const double k[6], const double x[4])
{
	out[0] = k[0] * x[0] + k[1] * x[1] + k[2] * x[2];
	out[1] = k[1] * x[0] + k[3] * x[1] + k[4] * x[2];
	out[2] = k[2] * x[0] + k[4] * x[1] + k[5] * x[2];
	out[3] = 0;
}

/* y = (stiffness R + K) x */
SIMD_CLONES static void times(four *restrict y, const struct nricp_graph *g, const double (*k)[6], double stiffness, const four *restrict x)
{
	for (int i = 0; i < g->n; i++) {
		double sum[4] = { 0 }, own[4];
		for (int32_t e = g->r_start[i]; e < g->r_start[i + 1]; e++) {
			const double *v = x[g->r_column[e]], w = g->r_value[e];
			SIMD_LOOP
			for (int c = 0; c < 4; c++)
				sum[c] += w * v[c];
		}
		block_times(own, k[i], x[i]);
		SIMD_LOOP
		for (int c = 0; c < 4; c++)
			y[i][c] = stiffness * sum[c] + own[c];
	}
}

/* b = K (goal - place) + stiffness pull */
static void right_side(four *b, const struct nricp_graph *g, const struct nricp_pulls *data, const four *pull, double stiffness)
{
	for (int i = 0; i < g->n; i++) {
		double d[4] = { 0 };
		for (int c = 0; c < 3; c++)
			d[c] = data->goal[i][c] - g->place[i][c];
		block_times(b[i], data->k[i], d);
		for (int c = 0; c < 3; c++)
			b[i][c] += stiffness * pull[i][c];
	}
}

static void invert_blocks(struct nricp_solver *s, const double (*k)[6], double stiffness)
{
	for (int i = 0; i < s->graph->n; i++) {
		double d = stiffness * s->graph->r_value[s->graph->r_start[i]];
		double a = k[i][0] + d, b = k[i][1], c = k[i][2], e = k[i][3] + d, f = k[i][4], h = k[i][5] + d;
		double x = e * h - f * f, y = c * f - b * h, z = b * f - c * e, det = a * x + b * y + c * z;
		double w = det > 0 ? 1 / det : 0;
		double inv[6] = { x * w, y * w, z * w, (a * h - c * c) * w, (b * c - a * f) * w, (a * e - b * b) * w };
		memcpy(s->inverse[i], inv, sizeof inv);
	}
}

SIMD_CLONES static double inner(int n, const four *restrict a, const four *restrict b)
{
	double sum[4] = { 0 };
	for (int i = 0; i < n; i++) {
		SIMD_LOOP
		for (int c = 0; c < 4; c++)
			sum[c] += a[i][c] * b[i][c];
	}
	return sum[0] + sum[1] + sum[2];
}

/* y = a x + s y when s is not 1, y += a x otherwise. */
SIMD_CLONES static void add(int n, four *restrict y, double s, double a, const four *restrict x)
{
	for (int i = 0; i < n; i++) {
		SIMD_LOOP
		for (int c = 0; c < 4; c++)
			y[i][c] = s * y[i][c] + a * x[i][c];
	}
}

static void precondition(struct nricp_solver *s)
{
	for (int i = 0; i < s->graph->n; i++)
		block_times(s->z[i], s->inverse[i], s->r[i]);
}

/* Preconditioned conjugate gradients; blocks of the diagonal. */
static void descend(struct nricp_solver *s, four *t, const double (*k)[6], double stiffness)
{
	int n = s->graph->n;
	invert_blocks(s, k, stiffness);
	times(s->r, s->graph, k, stiffness, t);
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 4; c++)
			s->r[i][c] = s->b[i][c] - s->r[i][c];
	precondition(s);
	memcpy(s->p, s->z, (size_t)n * sizeof *s->p);
	double rz = inner(n, s->r, s->z), stop = rz * s->tolerance * s->tolerance;
	for (int step = 0; step < s->steps && rz > stop && rz > 0; step++) {
		times(s->q, s->graph, k, stiffness, s->p);
		double pq = inner(n, s->p, s->q);
		if (!(pq > 0))
			return;
		add(n, t, 1, rz / pq, s->p);
		add(n, s->r, 1, -rz / pq, s->q);
		precondition(s);
		double next = inner(n, s->r, s->z);
		add(n, s->p, next / rz, 1, s->z);
		rz = next;
	}
}

static bool factored(struct nricp_solver *s, four *t, const double (*k)[6], double stiffness)
{
	static const int entry[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
	const struct nricp_graph *g = s->graph;
	for (int i = 0; i < 3 * g->n; i++) {
		int32_t at = s->start[i], node = i / 3;
		for (int32_t e = g->r_start[node]; e < g->r_start[node + 1]; e++)
			for (int c = 0; c < 3; c++)
				if (e == g->r_start[node])
					s->value[at++] = k[node][entry[i % 3][c]] + (c == i % 3 ? stiffness * g->r_value[e] : 0);
				else if (c == i % 3)
					s->value[at++] = stiffness * g->r_value[e];
	}
	if (!spd_factor(s->spd, s->value))
		return false;
	double *x = (double *)s->q;
	for (int i = 0; i < 3 * g->n; i++)
		x[i] = s->b[i / 3][i % 3];
	spd_solve(s->spd, x, x);
	for (int i = 0; i < 3 * g->n; i++)
		t[i / 3][i % 3] = x[i];
	return true;
}

void nricp_solver_run(struct nricp_solver *s, double (*t)[4], const struct nricp_pulls *data, const double (*pull)[4], double stiffness)
{
	right_side(s->b, s->graph, data, pull, stiffness);
	// Gradients do without a full rank: where nothing pulls, nothing moves.
	if (!s->spd || !factored(s, t, (const double(*)[6])data->k, stiffness))
		descend(s, t, (const double(*)[6])data->k, stiffness);
}
