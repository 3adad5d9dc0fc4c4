#include "tests/lib/scenes/irisphantom.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "math/rng.h"
#include "tests/lib/truth/photon.h"

static const double cell = 0.04;  // mm

/* Periodic: radial fibres, two furrows across them, and round crypts. */
static void relief(struct image *truth, double rough, uint64_t seed)
{
	struct rng rng = { seed };
	int n = truth->width;
	double side = n * cell, at[6][3];
	for (int k = 0; k < 6; k++) {
		at[k][0] = side * rng_uniform(&rng);
		at[k][1] = side * rng_uniform(&rng);
		at[k][2] = rng_range(&rng, 0.08, 0.2);
	}
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			double x = (i + 0.5) * cell, y = (j + 0.5) * cell, ln = 0;
			ln += 0.15 * sin(2 * M_PI * (6 * x + 0.4 * sin(4 * M_PI * y / side)) / side);
			ln += 0.12 * cos(4 * M_PI * y / side);
			for (int k = 0; k < 6; k++) {
				double dx = fabs(x - at[k][0]), dy = fabs(y - at[k][1]);
				dx = fmin(dx, side - dx) / at[k][2];
				dy = fmin(dy, side - dy) / (1.5 * at[k][2]);
				ln -= 0.5 * exp(-dx * dx - dy * dy);
			}
			image_at(truth, i, j)[0] = (float)(0.45 * exp(rough * ln));
		}
}

static void photograph(struct irisphantom *p, const struct tissue *t, double cos_light, long photons, uint64_t seed)
{
	struct tissue_bands bands;
	int n = p->truth.width;
	float *one = mem_array((size_t)n * n, sizeof *one);
	tissue_bands_make(&bands, 3, t->illuminant);
	for (int k = 0; k < bands.n; k++) {
		double s = tissue_scattering(bands.nm[k]), scale = t->thickness_scale;
		struct photon_slab slab = { n, cell, p->truth.px, t->abl_thickness, { s, scale * s }, {
			tissue_absorption(&t->layer[TISSUE_ABL], bands.nm[k]), scale * tissue_absorption(&t->layer[TISSUE_STROMA], bands.nm[k]) }, 0, false };
		photon_reflectance(one, &slab, cos_light, photons, 0, seed + (uint64_t)k);
		for (int i = 0; i < n * n; i++)
			for (int c = 0; c < 3; c++)
				p->clean.px[4 * i + c] += (float)(t->exposure * bands.rgb[k][c] * one[i]);
	}
	for (int i = 0; i < n * n; i++)
		p->clean.px[4 * i + 3] = 1;
	free(one);
}

struct irisphantom irisphantom_new(const struct tissue *tissue, int n, double rough, double cos_light, double gain,
                                   long photons, uint64_t seed)
{
	struct irisphantom p = { n * cell / 2, image_new(n, n, 1), image_new(n, n, 4), image_new(n, n, 1) };
	struct err err = { 0 };
	relief(&p.truth, rough, seed);
	photograph(&p, tissue, cos_light, photons, seed);
	float *wide = mem_array((size_t)n * n, sizeof *wide);
	for (int i = 0; i < n * n; i++) {
		const float *c = p.clean.px + 4 * i;
		p.coarse.px[i] = wide[i] = logf(fmaxf(0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2], 1e-4f));
	}
	cv_blur(wide, wide, n, n, 1, 0.6 / cell, &err);
	for (int i = 0; i < n * n; i++)
		p.coarse.px[i] = (float)(0.45 * exp(gain * (p.coarse.px[i] - wide[i])));
	free(wide);
	return p;
}

void irisphantom_free(struct irisphantom *p)
{
	image_free(&p->truth);
	image_free(&p->clean);
	image_free(&p->coarse);
}

double irisphantom_correlation(const struct image *a, const struct image *b, double *rms)
{
	long n = (long)a->width * a->height;
	double sa = 0, sb = 0, aa = 0, ab = 0, bb = 0;
	for (long i = 0; i < n; i++) {
		double x = log(a->px[i * a->channels]), y = log(b->px[i * b->channels]);
		sa += x / n;
		sb += y / n;
		aa += x * x / n;
		ab += x * y / n;
		bb += y * y / n;
	}
	aa -= sa * sa;
	ab -= sa * sb;
	bb -= sb * sb;
	*rms = sqrt(fmax(aa - 2 * ab + bb, 0));
	return ab / sqrt(aa * bb);
}
