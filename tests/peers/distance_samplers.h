/* distance_samplers: the three sampling methods of the skin paper (section 4.4), which distance_band() is compared with.
 * Frames, units, out, reach and cost are those of distance_band(); results do not depend on the number of threads.
 */
#ifndef TESTS_DISTANCE_SAMPLERS_H
#define TESTS_DISTANCE_SAMPLERS_H
#include "image/distance/distance.h"

/* Section 4.4.1, equiangular: one sample in each of n directions at a random share of reach, directions turned at
 * random per texel. seed: of these. */
void distance_equiangular(float *out, const struct distance_scene *scene, double reach, int n, unsigned seed,
                          struct distance_cost *cost);

struct distance_line {
	double first, growth;  // |h_0| in world units; mu of eqs. 4.9 and 4.11
	int steps;             // n_m
	bool turned;           // directions turned at random per texel
	unsigned seed;
};

/* Section 4.4.2, exponential line search in two passes: along y, then along x over the first pass's distances
 * (eq. 4.13). `steps` samples at most each way. */
void distance_exponential(float *out, const struct distance_scene *scene, double reach, const struct distance_line *line,
                          struct distance_cost *cost);

/* Section 4.4.3, backtracking line search: in each of n directions, halving between the texel and the sample at
 * reach, where that one is skin. line: steps, turned and seed are read. */
void distance_backtracking(float *out, const struct distance_scene *scene, double reach, int n,
                           const struct distance_line *line, struct distance_cost *cost);

#endif
