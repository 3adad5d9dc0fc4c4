/* Quadrature of the march. */
#include "draw/eye/march/nodes.h"

#include <math.h>
#include <pthread.h>

#include "draw/eye/look.h"

/* Gauss-Legendre on 0..1: Newton on the Legendre polynomial from Tricomi's start. */
static void gauss(int n, double node[], double weight[])
{
	for (int i = 0; i < n; i++) {
		double x = cos(M_PI * (i + 0.75) / (n + 0.5)), d = 1;
		for (int k = 0; k < 8; k++) {
			double p = 1, q = 0;
			for (int j = 1; j <= n; j++) {
				double r = q;
				q = p;
				p = ((2 * j - 1) * x * q - (j - 1) * r) / j;
			}
			d = n * (x * p - q) / (x * x - 1);
			x -= p / d;
		}
		node[i] = (1 - x) / 2;
		weight[i] = 1 / ((1 - x * x) * d * d);
	}
}

/* Gauss's rule for the weight exp(-c x) on 0..1: light that fades with depth is its polynomial of degree 0, so the nodes only have to
 * integrate the deviation from that. Orthogonal polynomials by Stieltjes' procedure on a fine rule; roots by
 * bisection between their changes of sign. */
enum { EXPONENTIAL_MAX = SCENE_EXPONENTIAL_MAX, FINE = 64 };

static double fine_node[FINE], fine_weight[FINE];
static pthread_once_t fine_once = PTHREAD_ONCE_INIT;

static void fine_make(void)
{
	gauss(FINE, fine_node, fine_weight);
}

struct stieltjes {
	double a[EXPONENTIAL_MAX], b[EXPONENTIAL_MAX], h[EXPONENTIAL_MAX];  // p_k+1 = (x - a_k) p_k - b_k p_k-1; h: norms
};

static void stieltjes(struct stieltjes *s, int n, double c)
{
	double w[FINE], p[FINE], before[FINE] = { 0 };
	const double *x = fine_node;
	pthread_once(&fine_once, fine_make);
	for (int i = 0; i < FINE; i++) {
		w[i] = fine_weight[i] * exp(-c * x[i]);
		p[i] = 1;
	}
	for (int k = 0; k < n; k++) {
		double norm = 0, first = 0;
		for (int i = 0; i < FINE; i++) {
			norm += w[i] * p[i] * p[i];
			first += w[i] * x[i] * p[i] * p[i];
		}
		s->h[k] = norm;
		s->a[k] = first / norm;
		s->b[k] = k ? norm / s->h[k - 1] : 0;
		for (int i = 0; i < FINE; i++) {
			double next = (x[i] - s->a[k]) * p[i] - s->b[k] * before[i];
			before[i] = p[i];
			p[i] = next;
		}
	}
}

/* p_n at x. */
static double polynomial(const struct stieltjes *s, int n, double x)
{
	double p = 1, before = 0;
	for (int k = 0; k < n; k++) {
		double next = (x - s->a[k]) * p - s->b[k] * before;
		before = p;
		p = next;
	}
	return p;
}

/* Christoffel's weight of a node at x. */
static double christoffel(const struct stieltjes *s, int n, double x)
{
	double p = 1, before = 0, sum = 0;
	for (int k = 0; k < n; k++) {
		sum += p * p / s->h[k];
		double next = (x - s->a[k]) * p - s->b[k] * before;
		before = p;
		p = next;
	}
	return 1 / sum;
}

void scene_exponential(int n, double c, double node[], double weight[])
{
	enum { GRID = 4000 };
	struct stieltjes s;
	stieltjes(&s, n, c);
	double last = polynomial(&s, n, 0);
	for (int i = 1, found = 0; i <= GRID && found < n; i++) {
		double now = polynomial(&s, n, (double)i / GRID), lo = (i - 1.0) / GRID, hi = (double)i / GRID;
		if (now * last <= 0 && now != 0) {
			for (int k = 0; k < 50; k++) {
				double mid = (lo + hi) / 2;
				*(polynomial(&s, n, mid) * last > 0 ? &lo : &hi) = mid;
			}
			node[found] = lo;
			weight[found++] = christoffel(&s, n, lo) * exp(c * lo);
		}
		last = now;
	}
}

double scene_thickness(const struct scene *s, int layer)
{
	const struct scene_level *l = &s->level[s->n_levels - 1];
	double thick = 0;
	for (int i = 0; i < l->n * l->n; i++)
		thick += l->relief[2 * i + 1] / (l->n * l->n);
	return layer == TISSUE_ABL ? s->optics.abl_thickness : thick;
}

/* Exponent c of light over a layer, in and out: mean extinction of the bands times the layer's mean thickness. */
static double fading(const struct scene *s, int layer)
{
	const struct tissue_optics *o = &s->optics;
	double sum = 0;
	for (int k = 0; k < o->n; k++)
		sum += o->extinction[layer][k] / o->n;
	return fmin(LOOK_WAYS * sum * scene_thickness(s, layer), SCENE_FADE_MAX);
}

/* Most steps go to the stroma; the anterior layer is thin, but most of the melanin is there. */
void scene_nodes_make(struct scene *s)
{
	int n = s->conf.steps, share = s->conf.quadrature == SCENE_EXPONENTIAL ? SCENE_SHARE : 3, in_abl = n / share > 1 ? n / share : 1, in[2] = { in_abl, n - in_abl };
	for (int l = 0; l < 2; l++) {
		s->n_nodes[l] = in[l];
		if (s->conf.quadrature == SCENE_EXPONENTIAL && in[l] <= EXPONENTIAL_MAX)
			scene_exponential(in[l], fading(s, l), s->node[l], s->weight[l]);
		else if (s->conf.quadrature != SCENE_MIDPOINT)
			gauss(in[l], s->node[l], s->weight[l]);
		else
			for (int i = 0; i < in[l]; i++) {
				s->node[l][i] = (i + 0.5) / in[l];
				s->weight[l][i] = 1.0 / in[l];
			}
	}
}
