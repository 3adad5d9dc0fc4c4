/* train_fold: the folds of a cross-validation, and the errors of held-out frames. */
#ifndef MODEL_TRAIN_FOLD_H
#define MODEL_TRAIN_FOLD_H
#include "model/train/impl.h"

enum { MOST_FOLDS = 20 };

/* The sample's frames of one part, as regressors and as scores: coordinates along the components of the whole clip. cv_free. */
struct cv {
	const struct train *t;
	const struct part *part;
	long m;
	int q, R;          // regressors, components
	double *x, *s;     // [m][q] regressors; [m][R] scores, px
	double *scaled;    // [m][q] regressors of comparable scale, for the radial basis functions
	double *rest;      // [m] squared length outside the components, px^2
	const double *w;   // [m] weights
	int *fold;         // [m] fold that holds the frame out; -1: none, it lies between two blocks
	int folds;
};

/* Weighted sums of held-out squared errors of one method, px^2. free(error). */
struct errors {
	int K;
	double *error;  // [MOST_FOLDS][K] of each fold, with 1..K components
	double none[MOST_FOLDS];  // of each fold, predicting the mean
};

struct errors errors_new(int K);

/* Normalised error with k + 1 components: root of error over that of the mean. *sigma (may be null): its standard error, by the
 * jackknife over the folds. NAN when no frame was held out. */
double errors_normalised(const struct errors *e, int folds, int k, double *sigma);

struct cv cv_new(const struct train *t, int part);
void cv_free(struct cv *cv);

/* Draws the folds at random, frame by frame, as in the paper: a held-out frame is then predicted from its neighbours. */
void cv_shuffle(struct cv *cv);

/* Weights [m] of the frames that fold f is trained on (test false) or tested with (true), 0 for others. free(). */
double *cv_weights(const struct cv *cv, int f, bool test);

/* Principal components of a fold's training frames, in the coordinates of the clip's: mean[R] and V[R][R] by columns, largest
 * first, out. Columns beyond the frames' rank are 0. w: of cv_weights. */
void cv_components(const struct cv *cv, const double *w, double *mean, double *V);

/* Adds the held-out errors of fold f for predicted scores y[m][R]; y null: for the measured scores, which leaves the error of
 * projecting onto the components mean, V. */
void cv_add_errors(struct errors *e, const struct cv *cv, int f, const double *y, const double *mean, const double *V);

#endif
