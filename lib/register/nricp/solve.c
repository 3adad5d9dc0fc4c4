#include "register/nricp/solve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"
#include "math/spd.h"

/* x, y, z and 0 in one register. Conjugate gradients work in single precision: they solve for a correction of t, from a residual
 * computed in double precision. */
typedef float four __attribute__((vector_size(16), aligned(16)));

struct nricp_solver {
	const struct nricp_graph *graph;
	int steps;
	double tolerance;
	double (*left)[4];              // residual
	four *d, *r, *z, *p, *q;
	four (*block)[3], (*inverse)[3];  // columns of the diagonal blocks
	float *off;                     // stiffness R beside the diagonal, R's pattern
	struct spd *spd;                // of the direct solver: 3 n rows; null: conjugate gradients
	int32_t *start;
	double *value;
};

/* The pattern of the full system, 3 n rows: R's, each entry a block of 3 x 3. */
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
	s->left = mem_array(n, sizeof *s->left);
	s->d = mem_array(n, sizeof *s->d);
	s->r = mem_array(n, sizeof *s->r);
	s->z = mem_array(n, sizeof *s->z);
	s->p = mem_array(n, sizeof *s->p);
	s->q = mem_array(n, sizeof *s->q);
	s->block = mem_array(n, sizeof *s->block);
	s->inverse = mem_array(n, sizeof *s->inverse);
	s->off = mem_array((size_t)graph->r_start[graph->n] + 1, sizeof *s->off);
	if (direct)
		expand(s);
	return s;
}

void nricp_solver_free(struct nricp_solver *s)
{
	if (!s)
		return;
	void *const all[] = { s->left, s->d, s->r, s->z, s->p, s->q, s->block, s->inverse, s->off, s->start, s->value };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	spd_free(s->spd);
	free(s);
}

/* left = K (goal - place - t) + stiffness (pull - R t) */
static void residual(double (*left)[4], const struct nricp_graph *g, const double (*t)[4], const struct nricp_pulls *data,
                     const double (*pull)[4], double stiffness)
{
	for (int i = 0; i < g->n; i++) {
		const double *k = data->k[i];
		double bent[3] = { pull[i][0], pull[i][1], pull[i][2] }, d[3];
		for (int32_t e = g->r_start[i]; e < g->r_start[i + 1]; e++) {
			const double *x = t[g->r_column[e]], w = g->r_value[e];
			bent[0] -= w * x[0];
			bent[1] -= w * x[1];
			bent[2] -= w * x[2];
		}
		for (int c = 0; c < 3; c++)
			d[c] = data->goal[i][c] - g->place[i][c] - t[i][c];
		left[i][0] = k[0] * d[0] + k[1] * d[1] + k[2] * d[2] + stiffness * bent[0];
		left[i][1] = k[1] * d[0] + k[3] * d[1] + k[4] * d[2] + stiffness * bent[1];
		left[i][2] = k[2] * d[0] + k[4] * d[1] + k[5] * d[2] + stiffness * bent[2];
		left[i][3] = 0;
	}
}

static four columns(const double *x)
{
	return (four){ (float)x[0], (float)x[1], (float)x[2], 0 };
}

/* stiffness R + K in single precision, and the inverses of its diagonal blocks, the preconditioner. */
static void take_system(struct nricp_solver *s, const double (*k)[6], double stiffness)
{
	const struct nricp_graph *g = s->graph;
	for (int i = 0; i < g->n; i++) {
		double on = stiffness * g->r_value[g->r_start[i]];
		double a = k[i][0] + on, b = k[i][1], c = k[i][2], e = k[i][3] + on, f = k[i][4], h = k[i][5] + on;
		double x = e * h - f * f, y = c * f - b * h, z = b * f - c * e, det = a * x + b * y + c * z;
		double w = det > 0 ? 1 / det : 0, q = w * (b * c - a * f);
		s->block[i][0] = columns((double[]){ a, b, c });
		s->block[i][1] = columns((double[]){ b, e, f });
		s->block[i][2] = columns((double[]){ c, f, h });
		s->inverse[i][0] = columns((double[]){ w * x, w * y, w * z });
		s->inverse[i][1] = columns((double[]){ w * y, w * (a * h - c * c), q });
		s->inverse[i][2] = columns((double[]){ w * z, q, w * (a * e - b * b) });
		for (int32_t j = g->r_start[i] + 1; j < g->r_start[i + 1]; j++)
			s->off[j] = (float)(stiffness * g->r_value[j]);
	}
}

SIMD_INLINE four block_times(const four m[3], four x)
{
	return m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
}

SIMD_INLINE double inner(four a, four b)
{
	four ab = a * b;
	return (double)(ab[0] + ab[1] + ab[2]);
}

/* q = A p; returns p' q. */
static double times(four *restrict q, const struct nricp_solver *s, const four *restrict p)
{
	const struct nricp_graph *g = s->graph;
	const int32_t *column = g->r_column;
	double sum = 0;
	for (int i = 0; i < g->n; i++) {
		four all = block_times(s->block[i], p[i]), odd = { 0 };
		int32_t e = g->r_start[i] + 1, end = g->r_start[i + 1];
		for (; e + 1 < end; e += 2) {  // two sums: neither waits for the other
			all += s->off[e] * p[column[e]];
			odd += s->off[e + 1] * p[column[e + 1]];
		}
		if (e < end)
			all += s->off[e] * p[column[e]];
		q[i] = all + odd;
		sum += inner(p[i], q[i]);
	}
	return sum;
}

/* d += step p, r -= step q, z = preconditioner r. Returns r' z. */
static double go(struct nricp_solver *s, float step)
{
	double sum = 0;
	for (int i = 0; i < s->graph->n; i++) {
		s->d[i] += step * s->p[i];
		s->r[i] -= step * s->q[i];
		s->z[i] = block_times(s->inverse[i], s->r[i]);
		sum += inner(s->r[i], s->z[i]);
	}
	return sum;
}

/* Conjugate gradients, preconditioned by the inverse diagonal blocks (block Jacobi). */
static void descend(struct nricp_solver *s, double (*t)[4], const double (*k)[6], double stiffness)
{
	int n = s->graph->n;
	take_system(s, k, stiffness);
	for (int i = 0; i < n; i++) {
		s->d[i] = s->p[i] = s->q[i] = (four){ 0 };
		s->r[i] = columns(s->left[i]);
	}
	double rz = go(s, 0), stop = rz * s->tolerance * s->tolerance;
	memcpy(s->p, s->z, (size_t)n * sizeof *s->p);
	for (int step = 0; step < s->steps && rz > stop && rz > 0; step++) {
		double pq = times(s->q, s, s->p);
		if (!(pq > 0))
			break;
		double next = go(s, (float)(rz / pq));
		float keep = (float)(next / rz);
		for (int i = 0; i < n; i++)
			s->p[i] = s->z[i] + keep * s->p[i];
		rz = next;
	}
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			t[i][c] += (double)s->d[i][c];
}

/* The direct solve. False: the matrix is not positive definite. */
static bool factored(struct nricp_solver *s, double (*t)[4], const double (*k)[6], double stiffness)
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
	double *x = mem_array(3 * (size_t)g->n + 1, sizeof *x);
	for (int i = 0; i < 3 * g->n; i++)
		x[i] = s->left[i / 3][i % 3];
	spd_solve(s->spd, x, x);
	for (int i = 0; i < 3 * g->n; i++)
		t[i / 3][i % 3] += x[i];
	free(x);
	return true;
}

void nricp_solver_run(struct nricp_solver *s, double (*t)[4], const struct nricp_pulls *data, const double (*pull)[4], double stiffness)
{
	residual(s->left, s->graph, (const double(*)[4])t, data, pull, stiffness);
	// Conjugate gradients need no full rank: nodes without a pull stay where they are.
	if (!s->spd || !factored(s, t, (const double(*)[6])data->k, stiffness))
		descend(s, t, (const double(*)[6])data->k, stiffness);
}
