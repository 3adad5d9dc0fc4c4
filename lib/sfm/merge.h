/* merge: joins models of one subject that the mapper left apart, where they share pictures.
 */
#ifndef SFM_MERGE_H
#define SFM_MERGE_H
#include "sfm/views.h"

enum { MODEL_TRIALS = 8 };
#define TRIALS CALIBRATE_DIR "/models"

/* Merges the model of TRIALS/at with each other one of TRIALS that shares pictures with it: COLMAP's merger, then its mapper, which
 * adjusts the whole and removes what then does not fit.
 * best      in: the model of TRIALS/at; out: the merged one, or the same where none fits
 * n_models  in: models in TRIALS; out: those that are left
 * Returns false, err set, when a program or the disk fails; that models do not fit is no error. */
bool merge_models(struct colmap_model *best, int *n_models, int at, const struct views *views, struct stage *stage,
                  const struct calibrate_options *o, struct err *err);

#endif
