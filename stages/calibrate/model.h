#ifndef STAGES_CALIBRATE_MODEL_H
#define STAGES_CALIBRATE_MODEL_H
#include "stages/calibrate/calibrate.h"

#define MODEL_DIR CALIBRATE_DIR "/model"

/* Why no two pictures could be put together, and what to photograph instead. Always false, err set. */
bool model_advice(const struct views *views, struct stage *stage, struct err *err);

/* Removes a model's files; dir: relative to the capture. */
void model_remove(struct stage *stage, const char *dir);

#endif
