/* record_holds: whether what a stage recorded of its last run (record.h) still holds. */
#ifndef BASE_RECORD_HOLDS_H
#define BASE_RECORD_HOLDS_H
#include "base/record.h"

/* Removes every file below `dir` ("work/calibrate") that the stage's last run recorded as made and that has other bytes now,
 * and calls dropped(ctx, file); for a stage that keeps files to go on from. What was changed by a run that did not finish is
 * no fault: from here to the next record_made nothing counts as recorded. */
typedef void record_dropped(void *ctx, const char *rel);
bool record_drop_altered(struct record *record, const char *dir, record_dropped *dropped, void *ctx, struct err *err);

/* True when everything the stage's last run recorded still holds: program, configuration as it would be now
 * (conf: all layers), listings, inputs, outputs. why (may be null): what does not; owned by the caller, free(). */
bool record_holds(const char *capture, const char *stage, const char *program_path, const struct conf *conf,
                  char **why);

#endif
