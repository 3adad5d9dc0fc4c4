/* All orders of forward scattering in parallel layers, by adding and doubling (van de Hulst; Plass, Kattawar and Catchings 1973), mean over
 * azimuth. Radiances at NODES cosines: Gauss's on 0..1, and those of view and light with next to no weight. r and t of a layer map
 * radiances that come in to those reflected and transmitted. The forward peak that so few nodes cannot hold counts as not scattered
 * (delta-M, Wiscombe 1977). */
#include <math.h>
#include <string.h>

#include "tissue/tissue.h"

enum { GAUSS = 5, VIEW = GAUSS, LIGHT, NODES, ORDERS = 2 * GAUSS };
_Static_assert((int)NODES == (int)TISSUE_NODES, "what a memo holds");

static const double gauss_node[GAUSS] = { 0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332 };
static const double gauss_weight[GAUSS] = { 0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095 };

typedef double matrix[NODES][NODES];

struct nodes {
	double mu[NODES], weight[NODES];
	matrix back, ahead;  // phase function between nodes, mean over azimuth, 1: isotropic
};

static void multiply(matrix out, const matrix a, const matrix b)
{
	for (int i = 0; i < NODES; i++)
		for (int j = 0; j < NODES; j++) {
			out[i][j] = 0;
			for (int k = 0; k < NODES; k++)
				out[i][j] += a[i][k] * b[k][j];
		}
}

/* out = (1 - a b)^-1 c, by elimination: no layer sends back more than it gets, so the diagonal dominates. */
static void between(matrix out, const matrix a, const matrix b, const matrix c)
{
	matrix m;
	multiply(m, a, b);
	for (int i = 0; i < NODES; i++)
		for (int j = 0; j < NODES; j++) {
			m[i][j] = (i == j) - m[i][j];
			out[i][j] = c[i][j];
		}
	for (int k = 0; k < NODES; k++)
		for (int i = 0; i < NODES; i++) {
			double f = i == k ? 0 : m[i][k] / m[k][k];
			for (int j = 0; j < NODES && i != k; j++) {
				m[i][j] -= f * m[k][j];
				out[i][j] -= f * out[k][j];
			}
		}
	for (int i = 0; i < NODES; i++)
		for (int j = 0; j < NODES; j++)
			out[i][j] /= m[i][i];
}

/* What a layer over a ground that reflects `below` sends back; the light that reaches the ground in down. */
static void add(matrix out, matrix down, const matrix r, const matrix t, const matrix below)
{
	matrix up, through;
	between(down, r, below, t);
	multiply(up, below, down);
	multiply(through, t, up);
	for (int i = 0; i < NODES; i++)
		for (int j = 0; j < NODES; j++)
			out[i][j] = r[i][j] + through[i][j];
}

static void twice(matrix r, matrix t)
{
	matrix sum, down, through;
	add(sum, down, r, t, r);
	multiply(through, t, down);
	memcpy(r, sum, sizeof(matrix));
	memcpy(t, through, sizeof(matrix));
}

static void nodes_make(struct nodes *n, double cos_view, double cos_light)
{
	const double g = TISSUE_ANISOTROPY, peak = pow(g, ORDERS);
	for (int i = 0; i < GAUSS; i++) {
		n->mu[i] = gauss_node[i];
		n->weight[i] = gauss_weight[i];
	}
	n->mu[VIEW] = cos_view;
	n->mu[LIGHT] = cos_light;
	n->weight[VIEW] = n->weight[LIGHT] = 1e-8;
	double p[NODES][ORDERS];
	for (int i = 0; i < NODES; i++) {
		p[i][0] = 1;
		p[i][1] = n->mu[i];
		for (int l = 2; l < ORDERS; l++)
			p[i][l] = ((2 * l - 1) * n->mu[i] * p[i][l - 1] - (l - 1) * p[i][l - 2]) / l;
	}
	memset(n->back, 0, sizeof n->back);
	memset(n->ahead, 0, sizeof n->ahead);
	for (int l = 0; l < ORDERS; l++) {
		double chi = (2 * l + 1) * (pow(g, l) - peak) / (1 - peak);
		for (int i = 0; i < NODES; i++)
			for (int j = 0; j < NODES; j++) {
				n->ahead[i][j] += chi * p[i][l] * p[j][l];
				n->back[i][j] += (l % 2 ? -chi : chi) * p[i][l] * p[j][l];
			}
	}
}

/* r and t of a layer of reduced optical depth source and absorption depth absorb: doubled from one so thin that it scatters once. */
static void layer(matrix r, matrix t, const struct nodes *n, double source, double absorb)
{
	const double g = TISSUE_ANISOTROPY, peak = pow(g, ORDERS), thin = 5e-4;
	double scatter = source / (1 - g) * (1 - peak), depth = scatter + absorb, albedo = depth > 0 ? scatter / depth : 0;
	int doublings = 0;
	for (depth = fmin(depth, 60); depth > thin; doublings++)
		depth /= 2;
	for (int i = 0; i < NODES; i++)
		for (int j = 0; j < NODES; j++) {
			double a = n->mu[i], b = n->mu[j], in = 2 * b * n->weight[j] * albedo / 4, left = exp(-depth / a);
			double passed = fabs(a - b) < 1e-6 ? depth / (a * a) * left : (left - exp(-depth / b)) / (a - b);
			r[i][j] = in * n->back[i][j] * (1 - exp(-depth * (1 / a + 1 / b))) / (a + b);
			t[i][j] = in * n->ahead[i][j] * passed + (i == j ? left : 0);
		}
	for (; doublings; doublings--)
		twice(r, t);
}

/* The same, from the memo (or null) where it has been made before; else kept there while there is room. The nodes are always the same ones. */
static void layer_of(matrix r, matrix t, struct tissue_memo *memo, const struct nodes *n, double source, double absorb)
{
	for (int i = 0; memo && i < memo->n; i++) {
		const struct tissue_doubled *of = &memo->of[i];
		if (of->source == source && of->absorb == absorb) {
			memcpy(r, of->r, sizeof(matrix));
			memcpy(t, of->t, sizeof(matrix));
			return;
		}
	}
	layer(r, t, n, source, absorb);
	if (!memo || memo->n == TISSUE_MEMO_MAX)
		return;
	struct tissue_doubled *of = &memo->of[memo->n++];
	of->source = source;
	of->absorb = absorb;
	memcpy(of->r, r, sizeof(matrix));
	memcpy(of->t, t, sizeof(matrix));
}

static double seen(const matrix r, const struct nodes *n)
{
	return r[VIEW][LIGHT] / (2 * n->mu[LIGHT] * n->weight[LIGHT]);
}

/* What the first order lacks, because the phase function was cut off (Nakajima and Tanaka 1988): nearly all there is where much is
 * absorbed. */
static double first_lacks(const struct nodes *n, const double extinction[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl, double stroma)
{
	enum { TURNS = 16 };
	const double g = TISSUE_ANISOTROPY, peak = pow(g, ORDERS);
	double u = n->mu[VIEW], v = n->mu[LIGHT], across = sqrt((1 - u * u) * (1 - v * v)), phase = 0, scaled[TISSUE_LAYERS], all[TISSUE_LAYERS];
	for (int i = 0; i < TURNS; i++)
		phase += (1 - g * g) / pow(1 + g * g - 2 * g * (across * cos(M_PI * (i + 0.5) / TURNS) - u * v), 1.5) / TURNS;
	for (int l = 0; l < TISSUE_LAYERS; l++) {
		scaled[l] = source[l] / (1 - g) * (1 - peak);
		all[l] = scaled[l] + extinction[l] - source[l];
	}
	return (phase / (1 - peak) - n->back[VIEW][LIGHT]) * tissue_reflectance_one(all, scaled, abl, stroma, u, v);
}

void tissue_reflectance_forward(double out[3], const double extinction[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl,
                                double stroma, double cos_view, double cos_light, struct tissue_memo *memo)
{
	struct nodes n;
	matrix top_r, top_t, r, t, all, down;
	nodes_make(&n, cos_view, cos_light);
	layer_of(top_r, top_t, memo, &n, source[TISSUE_ABL] * abl, (extinction[TISSUE_ABL] - source[TISSUE_ABL]) * abl);
	layer_of(r, t, memo, &n, source[TISSUE_STROMA] * stroma, (extinction[TISSUE_STROMA] - source[TISSUE_STROMA]) * stroma);
	out[0] = seen(top_r, &n) + first_lacks(&n, extinction, source, abl, 0);
	for (int i = 1; i < 3; i++) {
		add(all, down, top_r, top_t, r);
		out[i] = seen(all, &n) + first_lacks(&n, extinction, source, abl, i * stroma);
		if (i < 2)
			twice(r, t);
	}
}
