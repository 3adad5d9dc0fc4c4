/* train: fits the model of lids and skin (model/model.h) to a tracked clip (skin paper, sections 3.5 and 3.7).
 *
 * 1. A sample of bounded size is drawn, spread evenly over the clip. From it a robust principal component basis, the pilot, is
 *    estimated; distances from the pilot identify outlying frames, and the pilot fills in what was not measured.
 * 2. One pass over all frames sums weighted means and scatter matrices (math/scatter/scatter.h), in memory that does not grow
 *    with the clip: only the inputs, a dozen numbers a frame, are held.
 * 3. Components and regressions come from those sums; the number of components, the ridge, the curves of held-out error, the radial
 *    basis functions to compare with and the standard errors come from the sample.
 */
#ifndef MODEL_TRAIN_TRAIN_H
#define MODEL_TRAIN_TRAIN_H
#include "model/model.h"

/* A tracked clip. Coordinates and inputs that were not measured are NAN. All arrays are the caller's. */
struct train_clip {
	long n;                       // frames
	int n_au, n_points, n_vertices;  // no vertices: the lids alone are modelled
	const double *time;           // [n] s
	const double *g;              // [n][SKIN_EYE_INPUTS + n_au], gaze.csv's units
	const double *confidence;     // [n][2] left, right, 0..1
	long reference;               // the frame in which the subject's mesh matches the picture
	/* Reads n frames from `first`: lids lid[n][SKIN_LIDS * n_points * 2] and skin[n][2 n_vertices], px of the modelling
	 * camera, and the confidence of each vertex, seen[n][n_vertices] 0..1. Returns false, err set, when it cannot. */
	bool (*read)(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err);
	void *ctx;
	void (*progress)(void *ctx, long done, long total);  // called after each block of frames; or null
	const char *place;            // file that messages name first
};

struct train_conf {
	int lid_components, skin_components;  // of one eye's lids; of the skin
	bool choose;                  // these are limits: the fewest are kept that predict held-out frames no worse
	int curve_components;         // the curves of held-out error have so many points
	int sample;                   // most frames of the sample
	double block_s, guard_s;      // time blocks of the cross-validation and the gap between them, s
	int folds;
	double huber, trim;           // distance over its median: beyond huber a frame's weight falls (Huber), beyond trim it is 0
	double min_seen;              // share of frames in which a coordinate must be measured
	double gap_s;                 // gaps in the gaze up to this long (blinks) are interpolated
	double aperture_share;        // share of the frames that define closed and open
	double beyond;                // lids follow the gaze so far beyond the clip's, shares of its half width (known.h)
	int rbf_functions;            // largest network tried
	int memory_mb;                // limit of the scatter matrix and the sample, MiB
	bool brief;                   // no radial basis functions: the linear curves alone
};

enum { TRAIN_PARTS = 3, TRAIN_LEFT = 0, TRAIN_RIGHT = 1, TRAIN_SKIN = 2 };

/* One part of figure 3.7: the normalised error of held-out frames (0 perfect, 1 as bad as predicting the mean) against the
 * number of components, 1..n. */
struct train_curve {
	int n, kept;                  // components of the curves (0: the part is not modelled); components of the model
	double *linear, *rbf, *pca;   // [n] linear regression; radial basis functions; projection of the held-out shapes themselves
	double *random;               // [n] linear, frames held out at random as in the paper, so that neighbours leak
	double *linear_sigma, *rbf_sigma;  // [n] standard error over the folds
	double linear_px;             // root mean square held-out error of one coordinate at the components kept, px
	int rbf_functions;            // size of the network with the least error
	double rbf_width, ridge;
};

struct train_report {
	struct train_curve curve[TRAIN_PARTS];
	int rank_inputs[TRAIN_PARTS]; // rank of the regression's inputs
	int rank[TRAIN_PARTS];        // rank of the shapes: components above rounding, of at most 40
	int components95[TRAIN_PARTS], components99[TRAIN_PARTS];  // components that explain 95 and 99 % of the variance
	long used[TRAIN_PARTS];       // frames with a weight above 0
	long outside[TRAIN_PARTS];    // frames whose inputs have a leverage above SKIN_REACH (skin_model_leverage)
	double outlying[TRAIN_PARTS], filled[TRAIN_PARTS];  // share of frames with a reduced weight; of numbers filled in
	int unseen_vertices;
	double folding_px;            // largest difference over the sample between W and the three equations that it folds
	bool never_closed;            // the clip has no blink: g_closed is set to 0, the plane of the closed lid
	int n_warnings;
	char **warnings;              // [n_warnings] one line each
};

/* Fits the model to the clip.
 * model   overwritten; skin_model_free. The caller fills in au_names, vertices, camera and reference_frame afterwards
 * report  overwritten; train_report_free, in any case
 * Returns false, err set, when the clip has too few frames, shows too little, or would need more memory than conf->memory_mb. */
bool train_run(struct skin_model *model, struct train_report *report, const struct train_clip *clip,
               const struct train_conf *conf, struct err *err);
void train_report_free(struct train_report *report);

#endif
