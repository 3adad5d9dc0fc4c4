/* What the parts of infer share: infer.c (what is seen, and what of it the course and its light explain), infer_octaves.c (how much each octave varies, and by
 * what), infer_solve.c (the most probable relief and its sigma). For these files alone. */
#ifndef TISSUE_RELIEF_INFER_IMPL_H
#define TISSUE_RELIEF_INFER_IMPL_H
#include "tissue/relief/infer.h"
#include "tissue/relief/model.h"
#include "tissue/relief/shading.h"

enum { B = INFER_OCTAVES };

struct infer_grid {
	int n;
	double scale, sigma[B + 1];    // texels a mm; Gaussians between octaves, texels
	const struct infer_conf *conf;
	struct shading shading;
	float *course;                 // ln thickness
	float *weight;                 // 0..1
	float *off;                    // ln luminance that the course does not explain
	float *tint;                   // ln R/B, without its coarse part
	float *precise;                // 1 / variance of `off` in a texel
	double variance[B];            // of the process of each octave, as the conjugate gradients take it
	float *scratch[4];
};

/* Melanin's part of the contrast in each octave, squared: from ln R/B, less what thickness and noise change there. */
struct infer_colour {
	double tint, light;        // d ln R/B and d ln luminance by ln melanin
	double tint_of_thickness;  // d ln R/B by ln thickness over d ln luminance by it
};

static inline long infer_texels(const struct infer_grid *g)
{
	return (long)g->n * g->n;
}

/* Mean square of a map under the weights. */
double infer_square(const struct infer_grid *g, const float *map);

/* Of white noise of variance 1 through octave b. */
double infer_of_noise(const struct infer_grid *g, int b);

/* What a change of the border layer's melanin does to a texel of middling thickness, by pigment's model. */
struct infer_colour infer_colour_of(const double white[3], const double x[PIGMENT_N], const struct pigment_conf *pigment, const struct relief_conf *relief,
                                    const struct relief_table *here);

/* Takes the coarse part off what the photograph shows, weighs the texels, and finds how much each octave of relief varies, and what it is worth: fit but for
 * before, after, iterations; g->variance, g->precise. variance: out, of noise in each texel; edge: what spreading changes of the light, ln. */
bool infer_measure(struct infer_fit *fit, float *variance, struct infer_grid *g, const struct infer_colour *colour, const float *edge, struct err *err);

/* The posterior's mean, ln thickness beyond the course, and its standard deviation, [n][n] each. variance: of infer_measure. */
void infer_solve(float *relief, float *sigma, struct infer_fit *fit, struct infer_grid *g, const float *variance);

#endif
