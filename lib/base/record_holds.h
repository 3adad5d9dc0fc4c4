/* record_holds: whether what a stage recorded of its last run (record.h) still holds. */
#ifndef BASE_RECORD_HOLDS_H
#define BASE_RECORD_HOLDS_H
#include "base/record.h"

/* Removes every file below `dir` ("work/calibrate") that the stage's last run recorded as made and that has other bytes now, and
 * calls dropped(ctx, file) for each: for a stage that keeps files to continue from. Then saves the record as incomplete and without
 * outputs, so that files changed by a run that is interrupted are not removed by the next. Returns false, err set, when that
 * fails. */
typedef void record_dropped(void *ctx, const char *rel);
bool record_drop_altered(struct record *record, const char *dir, record_dropped *dropped, void *ctx, struct err *err);

/* Whether everything that the stage's last run recorded still holds: program, configuration, listings of folders, inputs, outputs.
 * conf  the configuration as it is now, all layers
 * why   null, or set to the first thing that has changed, free(); null when all holds */
bool record_holds(const char *capture, const char *stage, const char *program_path, const struct conf *conf,
                  char **why);

/* Whether all that the stage read in its last run is still there with the same bytes, listings too: what it made is of the capture as it is,
 * though perhaps not as this program and this configuration would make it. */
bool record_inputs_hold(const char *capture, const char *stage);

#endif
