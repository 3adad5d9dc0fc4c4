#ifndef STAGES_CALIBRATE_RUN_H
#define STAGES_CALIBRATE_RUN_H
#include "base/mem.h"
#include "base/stage.h"
#include "sfm/options.h"

/* All of it, whatever the folder holds. */
bool calibrate_run(struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
