/* rounds: pigment and relief in turn, as the iris paper's section 4 has it: each round fits the melanin to the relief of the one
 * before, and sharpens the coarse thickness anew under it, until the residuals stop falling. */
#ifndef TISSUE_ROUNDS_H
#define TISSUE_ROUNDS_H
#include "base/stage.h"
#include "tissue/relief/relief.h"

enum { TISSUE_ROUNDS_MAX = 10 };

/* One eye's maps; nothing is owned. */
struct tissue_maps {
	const struct image *clean, *thickness;  // R, G, B, W; coarse thickness, mm; the same square grid
	double extent;                          // their half-width, mm
	const struct pupil *pupil;
	double root;                            // radius of the iris' root, mm
	double white[3];                        // a white Lambertian surface in the texture's light
};

struct tissue_rounds_conf {
	struct pigment_conf pigment;
	struct pigment_classes_conf classes;
	struct relief_conf relief;
	int most;                               // rounds; at most TISSUE_ROUNDS_MAX
	double gain_min;                        // relative fall of the residuals that pays for another round
};

struct tissue_rounds {
	struct pigment_classes classes;
	struct pigment_fit fit;                 // of the last round; starts and minima of the first, which alone has several starts
	int n;                                  // rounds done
	double residual[TISSUE_ROUNDS_MAX];     // of the pigment fit, relative
	double relief[TISSUE_ROUNDS_MAX];       // rms difference of ln luminance after the filter
};

/* out    overwritten; owns no memory
 * stage  is told the progress
 * Returns false, err set, when too little of the iris was seen, or a fit fails. */
bool tissue_rounds(struct tissue_rounds *out, const struct tissue_maps *maps, const struct tissue_rounds_conf *conf, struct stage *stage,
                   struct err *err);

#endif
