/* run: the stage. */
#ifndef STAGES_CALIBRATE_RUN_H
#define STAGES_CALIBRATE_RUN_H
#include "base/stage.h"
#include "sfm/options.h"

/* Makes cameras, mesh and figure from whatever the folder holds. Of a video alone from which no cameras can be had it records that as
 * skipped; photographs that make no model are an error. Returns false, err set. */
bool calibrate_run(struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
