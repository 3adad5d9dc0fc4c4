/* train_cv: cross-validation over blocks of time (skin paper, figure 3.7). */
#ifndef MODEL_TRAIN_CV_H
#define MODEL_TRAIN_CV_H
#include "model/train/fold.h"

/* Chooses the part's ridge (part->ridge) and fills its curves in the report (report->curve[part]): the linear model, the radial
 * basis functions unless conf->brief, the components alone, and the linear model with frames held out at random. */
void train_validate(struct train *t, int part);

/* Normalised held-out error of the linear model for 1..K components, each with its best ridge.
 * least  [K], overwritten */
void cv_least(double *least, const struct cv *cv, int K);

#endif
