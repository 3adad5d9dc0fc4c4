#include "tissue/relief/shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tissue/relief/bell.h"
#include "tissue/spread.h"

static const double luminance[3] = { 0.2126, 0.7152, 0.0722 };

/* Absorption of slanted light on its way in, a mm of tissue above each depth, over all light that comes out: eq. in the header. */
static void weigh(struct shading *s, const struct tissue_optics *o, double thickness, double cos_view, double cos_light)
{
	enum { IN_STROMA = SHADING_DEPTHS - 1 };
	static const double node[IN_STROMA] = { 0.046910077, 0.230765345, 0.5, 0.769234655, 0.953089923 };  // Gauss
	static const double gauss[IN_STROMA] = { 0.118463443, 0.239314335, 0.284444444, 0.239314335, 0.118463443 };
	double path = 1 / cos_view + 1 / cos_light, all = 0, abl = o->abl_thickness;
	for (int j = 0; j < SHADING_DEPTHS; j++) {
		s->depth[j] = j ? abl + node[j - 1] * thickness : abl / 2;
		s->weight[j] = 0;
	}
	for (int k = 0; k < o->n; k++) {
		double seen = 0, through = exp(-o->extinction[TISSUE_ABL][k] * abl * path);
		for (int c = 0; c < 3; c++)
			seen += luminance[c] * o->rgb[k][c];
		for (int j = 0; j < SHADING_DEPTHS; j++) {
			int layer = j ? TISSUE_STROMA : TISSUE_ABL;
			double e = o->extinction[layer][k], length = j ? gauss[j - 1] * thickness : abl;
			double left = j ? through * exp(-e * (s->depth[j] - abl) * path) : e * abl * path > 1e-9 ? (1 - through) / (e * abl * path) : 1;
			double light = seen * o->source[layer][k] * left * length;
			all += light;
			s->weight[j] += light * e / cos_light;
		}
	}
	for (int j = 0; j < SHADING_DEPTHS; j++)
		s->weight[j] /= all > 0 ? all : 1;
}

void shading_make(struct shading *s, int n, double scale, const struct tissue *tissue, const struct tissue_optics *optics, double thickness,
                  double cos_view, double cos_light)
{
	size_t all = (size_t)n * (size_t)n;
	*s = (struct shading){ .n = n, .scale = scale, .spread = tissue_spread(tissue, TISSUE_SPREAD_NM, thickness) };
	weigh(s, optics, thickness, cos_view, cos_light);
	s->alpha = mem_array(all, sizeof *s->alpha);
	s->thick = mem_array(all, sizeof *s->thick);
	s->slant = mem_array(all, sizeof *s->slant);
	for (int k = 0; k < 2; k++)
		s->map[k] = mem_array(all, sizeof **s->map);
}

void shading_free(struct shading *s)
{
	free(s->alpha);
	free(s->thick);
	free(s->slant);
	for (int k = 0; k < 2; k++)
		free(s->map[k]);
	*s = (struct shading){ 0 };
}

/* Mean plus and minus sqrt(2) times the columns of the covariance's square root. */
void shading_slants(float to[SHADING_SLANTS][2], double scale, const double mean[2], const double c[3])
{
	double det = sqrt(fmax(c[0] * c[2] - c[1] * c[1], 0)), trace = sqrt(fmax(c[0] + c[2] + 2 * det, 1e-12));
	double root[2][2] = { { (c[0] + det) / trace, c[1] / trace }, { c[1] / trace, (c[2] + det) / trace } };
	for (int k = 0; k < SHADING_SLANTS; k++)
		for (int i = 0; i < 2; i++)
			to[k][i] = (float)(scale * (mean[i] + (k % 2 ? -M_SQRT2 : M_SQRT2) * root[k / 2][i]));
}

/* out = alpha spread(in), or spread(alpha in). */
static void spread(float *out, const float *in, struct shading *s, bool transposed)
{
	long n = (long)s->n * s->n;
	float *wide = s->map[0];
	for (long i = 0; i < n; i++)
		out[i] = wide[i] = transposed ? s->alpha[i] * in[i] : in[i];
	bell_blur(wide, s->n, TISSUE_SPREAD_WIDE * s->spread * s->scale, 2, s->map[1]);
	bell_blur(out, s->n, TISSUE_SPREAD_NARROW * s->spread * s->scale, 2, s->map[1]);
	for (long i = 0; i < n; i++)
		out[i] = (transposed ? 1 : s->alpha[i]) * ((float)TISSUE_SPREAD_SHARE * wide[i] + (float)(1 - TISSUE_SPREAD_SHARE) * out[i]);
}

/* The four texels about (x, y), and how much of each. */
struct between {
	long at;
	int right, down;
	float u, v;
};

static inline struct between between(int n, float x, float y)
{
	float most = (float)n - 1;
	x = x > 0 ? x < most ? x : most : 0;
	y = y > 0 ? y < most ? y : most : 0;
	int i = (int)x, j = (int)y;
	return (struct between){ (long)j * n + i, i + 1 < n, j + 1 < n ? n : 0, x - (float)i, y - (float)j };
}

void shading_apply(float *out, const float *d, struct shading *s)
{
	const int n = s->n;
	spread(out, d, s, false);
	float *h = s->map[0];
	for (long i = 0; i < (long)n * n; i++)
		h[i] = s->thick[i] * d[i];
#pragma omp parallel for schedule(static)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			long i = (long)y * n + x;
			float sum = 0;
			for (int j = 0; j < SHADING_DEPTHS; j++) {
				float u = (float)s->depth[j], there = 0;
				for (int k = 0; k < SHADING_SLANTS; k++) {
					struct between b = between(n, (float)x + u * s->slant[i][k][0], (float)y + u * s->slant[i][k][1]);
					const float *p = h + b.at, *q = p + b.down;
					there += (1 - b.v) * (p[0] + b.u * (p[b.right] - p[0])) + b.v * (q[0] + b.u * (q[b.right] - q[0]));
				}
				sum += (float)s->weight[j] * (h[i] - there / SHADING_SLANTS);
			}
			out[i] += sum;
		}
}

void shading_transposed(float *out, const float *light, struct shading *s)
{
	const int n = s->n;
	spread(out, light, s, true);
	float *h = s->map[0];
	memset(h, 0, (size_t)n * (size_t)n * sizeof *h);
	for (int y = 0; y < n; y++)  // one after the other, so that sums do not depend on the threads
		for (int x = 0; x < n; x++) {
			long i = (long)y * n + x;
			if (!(light[i] > 0 || light[i] < 0))
				continue;
			for (int j = 0; j < SHADING_DEPTHS; j++) {
				float u = (float)s->depth[j], w = (float)s->weight[j] * light[i], part = w / SHADING_SLANTS;
				h[i] += w;
				for (int k = 0; k < SHADING_SLANTS; k++) {
					struct between b = between(n, (float)x + u * s->slant[i][k][0], (float)y + u * s->slant[i][k][1]);
					float *p = h + b.at, *q = p + b.down;
					p[0] -= part * (1 - b.v) * (1 - b.u);
					p[b.right] -= part * (1 - b.v) * b.u;
					q[0] -= part * b.v * (1 - b.u);
					q[b.right] -= part * b.v * b.u;
				}
			}
		}
	for (long i = 0; i < (long)n * n; i++)
		out[i] += s->thick[i] * h[i];
}

double shading_response(const struct shading *s, double alpha, double thick, float (*const slant)[2], const double k[2])
{
	double square = (k[0] * k[0] + k[1] * k[1]) * pow(s->spread * s->scale, 2) / 2, re = 0, im = 0;
	re = alpha * (TISSUE_SPREAD_SHARE * exp(-square * TISSUE_SPREAD_WIDE * TISSUE_SPREAD_WIDE)
	              + (1 - TISSUE_SPREAD_SHARE) * exp(-square * TISSUE_SPREAD_NARROW * TISSUE_SPREAD_NARROW));
	for (int j = 0; j < SHADING_DEPTHS; j++)
		for (int i = 0; i < SHADING_SLANTS; i++) {
			double turn = s->depth[j] * (k[0] * (double)slant[i][0] + k[1] * (double)slant[i][1]), w = thick * s->weight[j] / SHADING_SLANTS;
			re += w * (1 - cos(turn));
			im -= w * sin(turn);
		}
	return re * re + im * im;
}
