/* skin/train: the model of lids and skin from a tracked clip (skin paper, sections 3.5 and 3.7).
 *
 * A bounded sample of frames, spread evenly, comes first: from it, robustly, a pilot basis that tells outlying frames
 * and fills in what was not seen, later the ridge, the cross-validation over blocks of time, the radial basis functions
 * and the standard errors. The components and the regressions themselves come from one pass over all frames
 * (math/scatter/scatter.h), in memory that does not grow with them: only the inputs, a dozen numbers a frame, are held.
 */
#ifndef MODEL_TRAIN_TRAIN_H
#define MODEL_TRAIN_TRAIN_H
#include "model/model.h"

/* Where a coordinate or a frame was not measured: NAN. */
struct train_clip {
	long n;                       // frames
	int n_au, n_points, n_vertices;
	const double *time;           // [n] s
	const double *g;              // [n][SKIN_EYE_INPUTS + n_au], gaze.csv's units
	const double *confidence;     // [n][2] left, right, 0..1
	long reference;               // the frame in which the subject's mesh lies on the picture
	/* n frames from `first`: lids lid[n][SKIN_LIDS * n_points * 2] and skin[n][2 n_vertices], px of the modelling camera,
	 * and how far each vertex is to be believed, seen[n][n_vertices] 0..1. */
	bool (*read)(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err);
	void *ctx;
	void (*progress)(void *ctx, long done, long total);  // or null
	const char *place;            // what messages begin with: "video/clip.mp4"
};

struct train_conf {
	int lid_components, skin_components;  // of one eye's lids; of the skin
	bool choose;                  // so many at most: no more than make held-out frames better predicted
	int curve_components;         // the curves go so far
	int sample;                   // frames of the bounded sample
	double block_s, guard_s;      // time blocks of the cross-validation and the gap between them, s
	int folds;
	double huber, trim;           // frames beyond huber times the usual distance weigh less; beyond trim nothing
	double min_seen;              // share of frames in which a coordinate must be measured
	double gap_s;                 // gaze is carried over gaps no longer than this (blinks)
	double aperture_share;        // share of the frames that define closed and open
	int rbf_functions;            // largest network tried
	int memory_mb;                // limit of the scatter matrix and the sample
	bool brief;                   // no radial basis functions: the linear curves alone
};

enum { TRAIN_PARTS = 3, TRAIN_LEFT = 0, TRAIN_RIGHT = 1, TRAIN_SKIN = 2 };

/* One part of figure 3.7: normalised error of held-out frames (0 perfect, 1 as bad as the mean). */
struct train_curve {
	int n, kept;                  // components 1..n; 0: part not modelled; of the model
	double *linear, *rbf, *pca;   // [n]; pca: the components alone, from the held-out shapes themselves
	double *random;               // [n] linear, frames held out at random as in the paper: neighbours leak
	double *linear_sigma, *rbf_sigma;  // [n] standard error over the folds
	double linear_px;             // rms a coordinate of the held-out error at the components kept, px
	int rbf_functions;            // the network that did best, NAN-free
	double rbf_width, ridge;
};

struct train_report {
	struct train_curve curve[TRAIN_PARTS];
	int rank_inputs[TRAIN_PARTS]; // of the regressions: inputs that vary by themselves
	int rank[TRAIN_PARTS];        // components that stand out of rounding, at most curve_components
	int components95[TRAIN_PARTS], components99[TRAIN_PARTS];  // that hold so much of the variance
	long used[TRAIN_PARTS];       // frames with a weight
	long outside[TRAIN_PARTS];    // frames whose inputs no frame with a weight is like (skin_model_leverage)
	double outlying[TRAIN_PARTS], filled[TRAIN_PARTS];  // share of frames weighed down; of numbers filled in
	int unseen_vertices;
	double folding_px;            // largest difference between the folded and the unfolded path over the sample
	bool never_closed;            // no blink: g_closed is the plane of the closed lid itself
	int n_warnings;
	char **warnings;              // [n_warnings] one line each
};

/* model: fresh (skin_model_free); of it n_au, au_names, vertices, camera and reference_frame are the caller's to fill in
 * afterwards. report: train_report_free in any case. False, err set, when the clip is not enough. */
bool train_run(struct skin_model *model, struct train_report *report, const struct train_clip *clip,
               const struct train_conf *conf, struct err *err);
void train_report_free(struct train_report *report);

#endif
