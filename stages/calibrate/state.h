/* state: the options with which database and model were made (work/calibrate/options.txt); with others they are made anew. */
#ifndef STAGES_CALIBRATE_STATE_H
#define STAGES_CALIBRATE_STATE_H
#include "base/stage.h"
#include "sfm/options.h"

/* Removes the database when options of features or matches differ from the recorded ones (or with --force), and the model when those or
 * its own differ. Returns false, err set, when a file cannot be removed. */
bool state_check(struct stage *stage, const struct calibrate_options *o, struct err *err);

/* Records the options. */
bool state_save(struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
