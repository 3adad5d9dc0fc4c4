#ifndef STAGES_CALIBRATE_MODEL_H
#define STAGES_CALIBRATE_MODEL_H
#include "stages/calibrate/calibrate.h"

#define MODEL_DIR CALIBRATE_DIR "/model"

/* Why no two pictures could be put together, and what to photograph instead. Always false, err set. */
bool model_advice(const struct views *views, struct stage *stage, struct err *err);

/* Whether nearly all pairs could be pictures of a plane, or from one place: cameras found from those mean nothing. */
bool model_is_flat(bool *flat, struct stage *stage, struct err *err);

/* A line for each picture that is not in the model, and why. */
void model_warn(const struct colmap_model *model, const struct views *views, struct stage *stage);

/* Removes a model's files; dir: relative to the capture. */
void model_remove(struct stage *stage, const char *dir);

#endif
