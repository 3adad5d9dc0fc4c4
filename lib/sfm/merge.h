/* merge: models of one subject that the mapper has left apart, joined where they share pictures. */
#ifndef SFM_MERGE_H
#define SFM_MERGE_H
#include "sfm/views.h"

enum { MODEL_TRIALS = 8 };
#define TRIALS CALIBRATE_DIR "/models"

/* best: the model of TRIALS/at, replaced by what it becomes with those others that fit: COLMAP's merger, then its mapper, which
 * adjusts all of it and leaves out what then does not fit. *n_models: how many there are, and then are left. False, err set, when a program or the
 * disk fails; that models do not fit is no error. */
bool merge_models(struct colmap_model *best, int *n_models, int at, const struct views *views, struct stage *stage,
                  const struct calibrate_options *o, struct err *err);

#endif
