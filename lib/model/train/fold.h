/* train_fold: one part of the sample for cross-validation, and the errors of frames held out. */
#ifndef MODEL_TRAIN_FOLD_H
#define MODEL_TRAIN_FOLD_H
#include "model/train/impl.h"

enum { MOST_FOLDS = 20 };

/* One part of the sample in the coordinates of its own components. */
struct cv {
	const struct train *t;
	const struct part *part;
	long m;
	int q, R;          // regressors, components
	double *x, *s;     // [m][q] regressors; [m][R] scores
	double *scaled;    // [m][q] regressors of comparable scale, for the networks
	double *rest;      // [m] squared length outside the components, px^2
	const double *w;   // [m]
	int *fold;         // [m]; -1: in a gap
	int folds;
};

/* Held-out squared errors of one method for 1..K components, and those of the mean, for each fold. */
struct errors {
	int K;
	double *error;  // [MOST_FOLDS][K]
	double none[MOST_FOLDS];
};

struct errors errors_new(int K);

/* Normalised error at k components (from 0); *sigma (may be null): its standard error over the folds. */
double errors_normalised(const struct errors *e, int folds, int k, double *sigma);

struct cv cv_new(const struct train *t, int part);
void cv_free(struct cv *cv);

/* As in the paper: frames drawn at random, so that a frame's neighbours tell of it. */
void cv_shuffle(struct cv *cv);

/* Weights of the frames that fold f is trained on (test false) or tested with. free(). */
double *cv_weights(const struct cv *cv, int f, bool test);

/* Components of the training frames of a fold, within those of the clip: mean[R], V[R][R], largest first; 0 where those frames
 * have no more. */
void cv_components(const struct cv *cv, const double *w, double *mean, double *V);

/* Adds fold f's held-out errors of predicted scores y[m][R] (null: the shapes' own, for the components alone). */
void cv_add_errors(struct errors *e, const struct cv *cv, int f, const double *y, const double *mean, const double *V);

#endif
