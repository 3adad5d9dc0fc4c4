#include "limbus/edge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/exp2.h"
#include "math/stats.h"

enum { MAX_ITER = 12, SMOOTH_ARCS = 9, PARAMS = 4 };
static const double RAMP_END = 2;   // sigma of the step
static const double SULCUS = 0.2;  // share of the sclera's shading that continues into the ramp

/* Eccentric angles equally spaced along the ellipse: the cumulated perimeter inverted. */
static void equal_arcs(double t[ARCS], const struct ellipse *e)
{
	enum { FINE = ARCS };
	double along[FINE + 1] = { 0 };
	for (int i = 0; i < FINE; i++) {
		double u = 2 * M_PI * (i + 0.5) / FINE;
		along[i + 1] = along[i] + hypot(e->a * sin(u), e->b * cos(u));
	}
	for (int k = 0, i = 0; k < ARCS; k++) {
		double want = along[FINE] * k / ARCS;
		while (along[i + 1] < want)
			i++;
		t[k] = 2 * M_PI * (i + (want - along[i]) / (along[i + 1] - along[i])) / FINE;
	}
}

/* Adds the samples of a line to v: from (x, y) on, px of the picture, every (dx, dy). */
struct line { float x, y, dx, dy; };

SIMD_CLONES static void add_line(float *restrict v, int m, const struct grey *grey, struct line at)
{
	const float *restrict px = grey->px;
	const int width = grey->width;
	const float right = (float)width - 1.001f, bottom = (float)grey->height - 1.001f;
	SIMD_LOOP for (int j = 0; j < m; j++) {
		float x = at.x + (float)j * at.dx, y = at.y + (float)j * at.dy;
		x = x > 0 ? x : 0;
		y = y > 0 ? y : 0;
		x = x < right ? x : right;
		y = y < bottom ? y : bottom;
		const int ix = (int)x, iy = (int)y, i = iy * width + ix;
		const float fx = x - (float)ix, top = px[i] + fx * (px[i + 1] - px[i]);
		const float low = px[i + width] + fx * (px[i + width + 1] - px[i + width]);
		v[j] += top + (y - (float)iy) * (low - top);
	}
}

static void sample_arc(struct ring *r, int arc, const struct grey *grey, double spacing, int most)
{
	const int across = (int)fmin(fmax(spacing / grey->scale, 1), most);
	const double nx = r->normal[arc][0], ny = r->normal[arc][1], bend = 0.5 / r->e.a;
	float *v = r->v + (long)arc * r->m;
	memset(v, 0, (size_t)r->m * sizeof *v);
	/* in px of the picture: start, and step along the profile */
	const double k = 1 / grey->scale;
	for (int i = 0; i < across; i++) {
		double q = ((i + 0.5) / across - 0.5) * spacing, in = q * q * bend - r->lo;
		const struct line at = { (float)((r->p[arc][0] - q * ny - in * nx - grey->x0) * k - 0.5), (float)((r->p[arc][1] + q * nx - in * ny - grey->y0) * k - 0.5),
			                 (float)(nx * r->step * k), (float)(ny * r->step * k) };
		add_line(v, r->m, grey, at);
	}
	for (int j = 0; j < r->m; j++)
		v[j] /= (float)across;
}

/* Where the profile of an arc ends on either side; and the box that all of its places lie in. */
static void place_arc(struct ring *r, double box[4], int arc, double spacing, int width, int height)
{
	const double nx = r->normal[arc][0], ny = r->normal[arc][1], hi = r->lo + r->step * (r->m - 1);
	double x0 = r->p[arc][0] + r->lo * nx, y0 = r->p[arc][1] + r->lo * ny;
	double x1 = r->p[arc][0] + hi * nx, y1 = r->p[arc][1] + hi * ny;
	r->inside[arc] = fmin(x0, x1) > 1 && fmax(x0, x1) < width - 1 && fmin(y0, y1) > 1 && fmax(y0, y1) < height - 1;
	const double beside = 0.5 * spacing + 0.125 * spacing * spacing / r->e.a;  // along the arc, and by its bend
	box[0] = fmin(x0, x1) - beside;
	box[1] = fmin(y0, y1) - beside;
	box[2] = fmax(x0, x1) + beside;
	box[3] = fmax(y0, y1) + beside;
}

struct ring ring_sample(const struct grey *grey, const struct ellipse *e, double lo, double hi, double step,
                        int across, int width, int height)
{
	struct ring r = { .e = *e, .m = (int)ceil((hi - lo) / step) + 1, .lo = lo, .step = step };
	const double spacing = ellipse_perimeter(e) / ARCS;
	double box[ARCS][4];
	r.v = mem_array((size_t)ARCS * (size_t)r.m, sizeof *r.v);
	equal_arcs(r.t, e);
	ellipse_points(ARCS, r.p, r.normal, e, r.t);
	for (int i = 0; i < ARCS; i++)
		place_arc(&r, box[i], i, spacing, width, height);
	grey_need(grey, ARCS, (const double (*)[4])box);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < ARCS; i++)
		sample_arc(&r, i, grey, spacing, across);
	return r;
}

void ring_free(struct ring *ring)
{
	free(ring->v);
	ring->v = 0;
}

static void insert(double at[], double strength[], int *n, double s, double value)
{
	if (*n == EDGE_CANDIDATES && strength[*n - 1] >= value)
		return;
	int i = *n < EDGE_CANDIDATES ? (*n)++ : *n - 1;
	for (; i > 0 && strength[i - 1] < value; i--) {
		at[i] = at[i - 1];
		strength[i] = strength[i - 1];
	}
	at[i] = s;
	strength[i] = value;
}

int edge_candidates(double at[EDGE_CANDIDATES], double strength[EDGE_CANDIDATES], const struct ring *r, int arc,
                    double half)
{
	const float *v = r->v + (long)arc * r->m;
	const int h = (int)fmax(half / r->step, 1);
	double in = 0, out = 0, before = -INFINITY, last = -INFINITY;
	int n = 0;
	for (int i = 0; i < EDGE_CANDIDATES; i++)
		at[i] = strength[i] = NAN;
	for (int j = 0; j < h; j++) {
		in += v[j];
		out += v[j + h];
	}
	for (int j = h; j + h <= r->m; j++) {  // step between samples j - 1 and j
		double now = (out - in) / h;
		if (last > 0 && last >= before && last > now)
			insert(at, strength, &n, r->lo + (j - 1.5) * r->step, last);
		before = last;
		last = now;
		if (j + h < r->m) {
			in += v[j] - v[j - h];
			out += v[j + h] - v[j];
		}
	}
	return n;
}

struct ring ring_typical(const struct ring *r, const bool use[ARCS], const double shift[ARCS])
{
	struct ring t = { .e = r->e, .m = r->m, .lo = r->lo, .step = r->step };
	t.v = mem_array((size_t)r->m, sizeof *t.v);
	for (int j = 0; j < r->m; j++) {
		double v[ARCS];
		int n = 0;
		for (int i = 0; i < ARCS; i++) {
			if (!use[i])
				continue;
			const float *p = r->v + (long)i * r->m;
			double u = fmin(fmax(j + shift[i] / r->step, 0), r->m - 1.001), in = 0, out = 0;
			const int at = (int)u, end = r->m / 8 + 1;
			for (int q = 0; q < end; q++) {
				in += p[q];
				out += p[r->m - 1 - q];
			}
			double value = p[at] + (u - at) * (p[at + 1] - p[at]);
			if (out > in)
				v[n++] = (value * end - in) / (out - in);
		}
		t.v[j] = (float)(n ? stats_median(n, v) : 0);
	}
	return t;
}

/* Logarithmic slope of the samples with s in [from, to]; NAN when there are too few or they are dark. */
static double log_slope(const struct ring *r, int arc, double from, double to)
{
	const float *v = r->v + (long)arc * r->m;
	double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
	for (int j = 0; j < r->m; j++) {
		double s = r->lo + j * r->step;
		if (s < from || s > to)
			continue;
		double y = log(fmax(v[j], 1e-3));
		n++;
		sx += s;
		sy += y;
		sxx += s * s;
		sxy += s * y;
	}
	double var = n * sxx - sx * sx;
	return n >= 3 && var > 0 ? (n * sxy - sx * sy) / var : NAN;
}

/* Median over the neighbours along the ring that have a value. */
static double smooth(const double v[ARCS], int arc, double fallback)
{
	double w[2 * SMOOTH_ARCS + 1];
	int n = 0;
	for (int i = -SMOOTH_ARCS; i <= SMOOTH_ARCS; i++) {
		double x = v[(arc + i + ARCS) % ARCS];
		if (isfinite(x))
			w[n++] = x;
	}
	return n >= 3 ? stats_median(n, w) : fallback;
}

void edge_slopes(struct step step[ARCS], const struct ring *r, double reach)
{
	double k[ARCS], m[ARCS];
	const double hi = r->lo + r->step * (r->m - 1);
	for (int i = 0; i < ARCS; i++) {
		bool use = step[i].ok && r->inside[i];
		k[i] = use ? log_slope(r, i, fmax(r->lo, step[i].d - 2.2 * reach), step[i].d - reach) : NAN;
		m[i] = use ? log_slope(r, i, step[i].d + reach, fmin(hi, step[i].d + 2.2 * reach)) : NAN;
	}
	for (int i = 0; i < ARCS; i++) {
		/* Slopes that change the brightness by more than e over the ramp are texture, not shading. */
		step[i].k = fmin(fmax(smooth(k, i, 0), -1 / reach), 0.5 / reach);
		step[i].m = fmin(fmax(smooth(m, i, 0), -0.4 / reach), 0.4 / reach);
		step[i].steep = fabs(step[i].m) * reach > 0.39;
	}
}

struct normal {
	double h[PARAMS][PARAMS], g[PARAMS], ss, weight;
};

/* Upper tail of the normal distribution beyond -z, given e = exp(-z²/2): Abramowitz and Stegun 7.1.26, to 1.5e-7. */
SIMD_INLINE double normal_cdf(double z, double e)
{
	const double t = 1 / (1 + 0.3275911 * M_SQRT1_2 * fabs(z));
	const double tail = 0.5 * e * t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
	return 0.5 + copysign(0.5 - tail, z);
}

/* Beyond that a power of e is nothing, or none of an iris. */
SIMD_INLINE double within(double x)
{
	const double most = 60, up = x > -most ? x : -most;
	return up < most ? up : most;
}

/* Sums over a profile, one for each sample of a block: their order, and so the last digit, is the same in every instruction set. Parameters: in, out, d, w. */
enum { LANES = 8 };
struct lanes { double ss[LANES], weight[LANES], g[PARAMS][LANES], h[PARAMS][PARAMS][LANES]; };

/* Places of a profile's samples, the window, and the step. */
struct model { double lo, step, center, per_window, per_w, ramp, dense, d, k, m, in, out; };

/* Adds a block of samples y that begins with sample `first`; there: 1, or 0 beyond the last. */
SIMD_CLONES static void add_block(struct lanes *restrict sums, const double *restrict y, const double *restrict there, int first, const struct model *restrict at)
{
	const struct model f = *at;
	SIMD_LOOP for (int l = 0; l < LANES; l++) {
		const double s = f.lo + (first + l) * f.step, x = (s - f.center) * f.per_window, z = (s - f.d) * f.per_w;
		/* a window with compact support, near to a Gaussian of sigma `window` */
		const double near = 1 - 0.25 * x * x, weight = there[l] * near * near;
		const double e = exp_quick(within(-0.5 * z * z)), iris = exp_quick(within(f.k * s));
		const double A = normal_cdf(z, e), beyond = s - f.center - f.ramp, sclera = 1 + f.m * (beyond > 0 ? beyond : SULCUS * beyond);
		const double j0 = (1 - A) * iris, j1 = A * sclera, j2 = (f.in * iris - f.out * sclera) * e * f.dense, j3 = j2 * z;
		const double res = y[l] - (j0 * f.in + j1 * f.out), w0 = weight * j0, w1 = weight * j1, w2 = weight * j2, w3 = weight * j3;
		sums->ss[l] += weight * res * res;
		sums->weight[l] += weight;
		sums->g[0][l] += w0 * res;
		sums->g[1][l] += w1 * res;
		sums->g[2][l] += w2 * res;
		sums->g[3][l] += w3 * res;
		sums->h[0][0][l] += w0 * j0;
		sums->h[1][0][l] += w1 * j0;
		sums->h[1][1][l] += w1 * j1;
		sums->h[2][0][l] += w2 * j0;
		sums->h[2][1][l] += w2 * j1;
		sums->h[2][2][l] += w2 * j2;
		sums->h[3][0][l] += w3 * j0;
		sums->h[3][1][l] += w3 * j1;
		sums->h[3][2][l] += w3 * j2;
		sums->h[3][3][l] += w3 * j3;
	}
}

static double sum_of(const double lane[LANES])
{
	double sum = 0;
	for (int l = 0; l < LANES; l++)
		sum += lane[l];
	return sum;
}

/* Model and derivatives summed over the profile. */
static void accumulate(struct normal *n, const struct step *f, const struct ring *r, int arc, double center, double window)
{
	const float *v = r->v + (long)arc * r->m;
	const int from = (int)fmax(ceil((center - 2 * window - r->lo) / r->step), 0), to = (int)fmin(floor((center + 2 * window - r->lo) / r->step), r->m - 1);
	const struct model model = { r->lo, r->step, center, 1 / window, 1 / f->w, RAMP_END * f->w, 1 / (sqrt(2 * M_PI) * f->w), f->d, f->k, f->m, f->in, f->out };
	struct lanes sums = { 0 };
	for (int j = from; j <= to; j += LANES) {
		double y[LANES], there[LANES];
		for (int l = 0; l < LANES; l++) {
			there[l] = j + l <= to;
			y[l] = (double)v[j + l < to ? j + l : to];
		}
		add_block(&sums, y, there, j, &model);
	}
	n->ss = sum_of(sums.ss);
	n->weight = sum_of(sums.weight);
	for (int a = 0; a < PARAMS; a++) {
		n->g[a] = sum_of(sums.g[a]);
		for (int b = 0; b <= a; b++)
			n->h[a][b] = sum_of(sums.h[a][b]);
	}
}

void edge_fit(struct step *f, const struct ring *r, int arc, double window, bool free_width)
{
	const int np = free_width ? 4 : 3;
	const double center = f->d, w0 = f->w;
	struct normal n;
	f->ok = false;
	/* linear start: in and out for the given d, w */
	f->in = f->out = 0;
	double h[PARAMS][PARAMS], g[PARAMS];
	for (int it = 0; it < MAX_ITER; it++) {
		accumulate(&n, f, r, arc, center, window);
		memcpy(h, n.h, sizeof h);
		memcpy(g, n.g, sizeof g);
		int now = it == 0 ? 2 : np;
		for (int a = 0; a < now; a++)
			h[a][a] *= 1 + 1e-9;
		if (!chol_solve(now, PARAMS, &h[0][0], g))
			return;
		f->in += g[0];
		f->out += g[1];
		if (now > 2)
			f->d += fmin(fmax(g[2], -f->w), f->w);
		if (now > 3)
			f->w = fmin(fmax(f->w + fmin(fmax(g[3], -0.4 * f->w), 0.6 * f->w), 0.3 * r->step), 4 * w0);
		if (fabs(f->d - center) > 1.5 * window)
			return;
		if (now > 2 && fabs(g[2]) < 1e-4 * f->w)
			break;
	}
	accumulate(&n, f, r, arc, center, window);
	double in = f->in * exp(f->k * f->d), out = f->out, jump = out - in;
	if (!(jump > 0) || !(n.weight > np) || !isfinite(jump))
		return;
	memcpy(h, n.h, sizeof h);
	double unit[PARAMS] = { 0, 0, 1, 0 };
	if (!chol_solve(np, PARAMS, &h[0][0], unit))
		return;
	f->rms = sqrt(n.ss / n.weight) / jump;
	f->sigma_d = sqrt(unit[2] * n.ss / (n.weight - np));
	f->contrast = jump / (fabs(out) + fabs(in));
	f->ok = true;
}
