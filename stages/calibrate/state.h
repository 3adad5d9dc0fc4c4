/* state: with which options the database and the model were made: others make them anew. */
#ifndef STAGES_CALIBRATE_STATE_H
#define STAGES_CALIBRATE_STATE_H
#include "base/stage.h"
#include "sfm/options.h"

/* Removes the database when features or matches would come out otherwise now (or with --force), and the model when it or
 * the database would. */
bool state_check(struct stage *stage, const struct calibrate_options *o, struct err *err);

/* Records the options that what is kept stands for. */
bool state_save(struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
