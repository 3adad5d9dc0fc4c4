#include "register/nricp/energy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* out = m^-1, m symmetric positive definite. */
static void inverse(double out[3][3], const double m[3][3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
			out[j][i] = m[p][r] * m[q][s] - m[p][s] * m[q][r];
		}
	double det = m[0][0] * out[0][0] + m[0][1] * out[1][0] + m[0][2] * out[2][0];
	for (int i = 0; i < 9; i++)
		(&out[0][0])[i] /= det;
}

/* star and ridge of node i. */
static void factor_star(struct nricp_graph *g, int i, double rigidity)
{
	double m[3][3] = { 0 }, inv[3][3], trace = 0;
	int32_t degree = g->start[i + 1] - g->start[i];
	for (int32_t e = g->start[i]; e < g->start[i + 1]; e++) {
		const double *a = g->place[i], *b = g->place[g->neighbour[e]];
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				m[r][c] += (b[r] - a[r]) * (b[c] - a[c]);
	}
	trace = m[0][0] + m[1][1] + m[2][2];
	g->spacing2[i] = degree ? trace / degree : 0;
	if (!(trace > 0))
		return;
	double rho = trace * g->spacing2[i] / (rigidity * rigidity);
	for (int k = 0; k < 3; k++)
		m[k][k] += rho;
	inverse(inv, (const double(*)[3])m);
	for (int k = 0; k < 9; k++)
		g->ridge[9 * (size_t)i + (size_t)k] = rho * (&inv[0][0])[k];
	for (int32_t e = g->start[i]; e < g->start[i + 1]; e++) {
		const double *a = g->place[i], *b = g->place[g->neighbour[e]];
		for (int r = 0; r < 3; r++)
			g->star[3 * (size_t)e + (size_t)r] = inv[r][0] * (b[0] - a[0]) + inv[r][1] * (b[1] - a[1]) + inv[r][2] * (b[2] - a[2]);
	}
}

/* Weight of a star. Its residual is half the second derivative times the squared spacing; with this weight the sum over all stars
 * approximates the integral of the squared second derivatives, whatever the spacing. */
static double star_weight(const struct nricp_graph *g, int i, double floor2)
{
	int32_t degree = g->start[i + 1] - g->start[i];
	double h2 = fmax(g->spacing2[i], floor2);
	return degree && h2 > 0 ? 4 * g->area[i] / (degree * h2 * h2) : 0;
}

/* S of star i, rows and columns: the node itself, then its neighbours; [1 + degree][1 + degree]:
 * Q_jk = w (delta_jk - e_j' star_k) for edges j, k of the star, and the node's own so that rows and columns sum to 0. */
static void star_form(double *s, const struct nricp_graph *g, int i, double weight)
{
	int32_t first = g->start[i], degree = g->start[i + 1] - first, m = degree + 1;
	const double *a = g->place[i], *star = g->star + 3 * (size_t)first;
	memset(s, 0, (size_t)m * sizeof *s);
	for (int32_t j = 0; j < degree; j++) {
		const double *b = g->place[g->neighbour[first + j]];
		double x = weight * (b[0] - a[0]), y = weight * (b[1] - a[1]), z = weight * (b[2] - a[2]), sum = 0;
		double *line = s + (size_t)(j + 1) * (size_t)m;
		for (int32_t k = 0; k < degree; k++) {
			double q = (j == k ? weight : 0) - x * star[3 * k] - y * star[3 * k + 1] - z * star[3 * k + 2];
			line[k + 1] = q;
			s[k + 1] -= q;
			sum += q;
		}
		line[0] = -sum;
		s[0] += sum;
	}
}

/* The sparsity pattern of R: nodes that share a star. */
static void pattern(struct nricp_graph *g)
{
	int32_t *seen = mem_array((size_t)g->n + 1, sizeof *seen), room = 24 * g->n + 64, n = 0;
	g->r_start = mem_new((size_t)g->n + 1, sizeof *g->r_start);
	g->r_column = mem_array((size_t)room, sizeof *g->r_column);
	for (int i = 0; i < g->n; i++)
		seen[i] = -1;
	for (int i = 0; i < g->n; i++) {
		seen[i] = i;
		int32_t begin = n;
		for (int32_t e = g->start[i] - 1; e < g->start[i + 1]; e++) {
			int32_t s = e < g->start[i] ? i : g->neighbour[e];
			for (int32_t k = g->start[s] - 1; k < g->start[s + 1]; k++) {
				int32_t v = k < g->start[s] ? s : g->neighbour[k];
				if (seen[v] == i && v != i)
					continue;
				if (v == i && n > begin && g->r_column[begin] == i)
					continue;
				if (n + 1 >= room)
					g->r_column = mem_grow(g->r_column, (size_t)(room *= 2), sizeof *g->r_column);
				seen[v] = i;
				g->r_column[n++] = v;  // the diagonal comes first
			}
		}
		g->r_start[i + 1] = n;
	}
	free(seen);
}

/* Sums all stars into R. */
static void fill(struct nricp_graph *g, double floor2)
{
	int32_t *at = mem_array((size_t)g->n + 1, sizeof *at);
	double *s = 0;
	int room = 0;
	int32_t *star_at = mem_array((size_t)g->n + 1, sizeof *star_at);
	size_t total = 0;
	for (int i = 0; i < g->n; i++) {
		star_at[i] = (int32_t)total;
		size_t m = (size_t)(g->start[i + 1] - g->start[i]) + 1;
		total += m * m;
		room = (int)m > room ? (int)m : room;
	}
	s = mem_array(total + 1, sizeof *s);
	for (int i = 0; i < g->n; i++)
		star_form(s + star_at[i], g, i, star_weight(g, i, floor2));
	for (int i = 0; i < g->n; i++)
		for (int32_t e = g->r_start[i]; e < g->r_start[i + 1]; e++)
			g->r_value[e] = 0;
	for (int i = 0; i < g->n; i++) {
		for (int32_t e = g->r_start[i]; e < g->r_start[i + 1]; e++)
			at[g->r_column[e]] = e;
		for (int32_t e = g->start[i] - 1; e < g->start[i + 1]; e++) {
			int32_t c = e < g->start[i] ? i : g->neighbour[e], m = g->start[c + 1] - g->start[c] + 1, own = 0;
			while (c != i && g->neighbour[g->start[c] + own] != i)
				own++;
			const double *line = s + star_at[c] + (size_t)(c == i ? 0 : own + 1) * (size_t)m;
			for (int32_t k = 0; k < m; k++)
				g->r_value[at[k ? g->neighbour[g->start[c] + k - 1] : c]] += line[k];
		}
	}
	free(at);
	free(s);
	free(star_at);
}

void nricp_graph_energy(struct nricp_graph *g, double rigidity)
{
	size_t n = (size_t)g->n, edges = (size_t)g->start[g->n];
	double mean2 = 0;
	g->spacing2 = mem_new(n + 1, sizeof *g->spacing2);
	g->star = mem_new(3 * edges + 1, sizeof *g->star);
	g->ridge = mem_new(9 * n + 1, sizeof *g->ridge);
	for (int i = 0; i < g->n; i++) {
		factor_star(g, i, rigidity);
		mean2 += g->spacing2[i] / g->n;
	}
	pattern(g);
	g->r_value = mem_array((size_t)g->r_start[g->n] + 1, sizeof *g->r_value);
	fill(g, 0.25 * mean2);
	g->floor2 = 0.25 * mean2;
}

void nricp_graph_pull(double (*out)[4], const struct nricp_graph *g, const double (*turn)[9])
{
	memset(out, 0, (size_t)g->n * sizeof *out);
	for (int i = 0; i < g->n; i++) {
		// Sum_k Q_jk (R_i - I) e_k = w (R_i - I) ridge_i e_j: the part that the best affine map does not absorb.
		const double *t = turn[i], *m = g->ridge + 9 * (size_t)i;
		double tm[3][3], w = star_weight(g, i, g->floor2);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				tm[r][c] = w * (t[3 * r] * m[c] + t[3 * r + 1] * m[3 + c] + t[3 * r + 2] * m[6 + c]);
		for (int32_t e = g->start[i]; e < g->start[i + 1]; e++) {
			int32_t j = g->neighbour[e];
			for (int r = 0; r < 3; r++) {
				double pull = 0;
				for (int c = 0; c < 3; c++)
					pull += tm[r][c] * (g->place[j][c] - g->place[i][c]);
				out[j][r] += pull;
				out[i][r] -= pull;
			}
		}
	}
}
