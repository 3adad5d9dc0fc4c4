/* infer: the relief that explains the photograph's shading under its light: ln thickness about a smooth course, the most probable one.
 *
 * The photograph's ln luminance, less that of its light and of the course, is the shading of what relief there is beyond the course
 * (shading.h) plus an error. A priori that relief is Gaussian: one process an octave of its spectrum. How much each varies the photograph
 * itself tells (empirical Bayes): the contrast in that octave, less noise's share and melanin's, over the shading's response; no more than
 * conf.most. What is above that is no relief, and counts as error there. So an octave whose contrast is noise gets no relief, and one that
 * is sharp gets the true amplitude.
 * - Noise: white; its local strength is that of the finest octave, all of whose contrast counts as noise. Light spreads further than that in
 *   tissue: contrast as fine is hardly ever relief.
 * - Melanin that is uneven changes red and blue apart, by what pigment's model says: so much of each octave's contrast in ln R/B is not relief.
 * The posterior's mean is (C A^T (A C A^T + N)^-1) residual, by conjugate gradients; its variance is taken as that of each octave alone.
 */
#ifndef TISSUE_RELIEF_INFER_H
#define TISSUE_RELIEF_INFER_H
#include "tissue/relief/relief.h"

enum { INFER_OCTAVES = 4 };

struct infer_fit {
	double rms[INFER_OCTAVES];       // a priori, of ln thickness
	double response[INFER_OCTAVES];  // d ln luminance over d ln thickness, rms
	double contrast[INFER_OCTAVES];  // of ln luminance, rms, less the course's and the light's
	double other[INFER_OCTAVES];     // of it, what is neither noise nor relief, rms
	double noise;                    // of ln luminance of a texel of the fit, rms
	double before, after;            // residual of ln luminance, rms: of the course, of the relief
	int iterations;
};

struct infer_conf {
	double finest;        // mm: Gaussian at which octaves begin; each following is twice as wide
	double most;          // rms of ln thickness in an octave, at most
	double response_error; // of the shading's response, relative: model error
	double light_error;   // of ln light that is reckoned, in an octave, rms
	double edge;          // error of ln light where it is spread at an edge, of what spreading changes
};

/* out  new, 2 channels on the grid of clean: thickness, mm, and the standard deviation of its detail, mm (of what is narrower than the
 *      coarsest octave: that of the course is thickness' own); image_free
 * light  of iris_lit, the same extent
 * Others as in relief_solve. Where nothing was seen the course remains. The same bits for any number of threads.
 * Returns false, err set, when too few texels were seen. */
bool relief_infer(struct image *out, struct infer_fit *fit, const struct image *clean, const struct image *thickness, const struct image *light,
                  double extent, const struct pupil *pupil, double root, const double white[3], const double x[PIGMENT_N],
                  const struct pigment_conf *pigment, const struct relief_conf *relief, const struct infer_conf *conf, struct err *err);

#endif
