/* linear_clip: a clip made by the very equations that train fits, so that what it must find is known: eyes that look
 * about and blink, lids l = l0 + P g, skin u = u0 + Q [l; au], with noise, gaps and outlying frames on demand.
 */
#ifndef TESTS_LINEAR_CLIP_H
#define TESTS_LINEAR_CLIP_H
#include <stdint.h>

#include "model/train/train.h"

struct linear_clip_conf {
	long n;
	int n_points, n_vertices, n_au;
	double fps, noise;          // px
	double missing;             // share of skin numbers not seen
	double outliers;            // share of frames thrown off by 200 px
	bool no_right, no_blink;
	bool repeated;              // every frame stands there twice
	double scale;               // of all px; 1
	uint64_t seed;
};

struct linear_clip {
	struct linear_clip_conf conf;
	double *time, *g, *confidence;
	double *l0, *P;             // [n_lid], [n_lid][10]: own eye's inputs alone
	double *u0, *Q;             // [2 n_vertices], [2 n_vertices][n_lid + n_au], of rank 4
	double closed[SKIN_EYE_INPUTS], open[SKIN_EYE_INPUTS], A[2][2][3];
};

struct linear_clip *linear_clip_new(const struct linear_clip_conf *conf);
void linear_clip_free(struct linear_clip *clip);
struct train_clip linear_clip_train(struct linear_clip *clip);

/* Lids and skin without noise, for inputs g. */
void linear_clip_truth(double *l, double *u, const struct linear_clip *clip, const double *g);

/* config/train.conf's values; a short clip's worth of them. */
extern const struct train_conf train_defaults;

#endif
