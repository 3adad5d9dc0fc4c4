/* kept: the files of work/calibrate/ that one run leaves for the next. One that was deleted or changed since is made anew. */
#ifndef STAGES_CALIBRATE_KEPT_H
#define STAGES_CALIBRATE_KEPT_H
#include "sfm/views.h"

/* Removes the files that are not as the last run left them, with a warning for each. To be called before anything is read. */
bool kept_check(struct stage *stage, struct err *err);

/* Records the hashes of the files that there are, for kept_check of the next run. whole: the database, too, at the end of a run. While a
 * run goes on the database keeps changing; an interrupted run's is used as long as SQLite finds it sound. */
bool kept_record(struct stage *stage, const struct views *views, bool whole, struct err *err);

#endif
