/* kept: what the stage goes on from when photographs are added. A file of it that was deleted or changed is made anew. */
#ifndef STAGES_CALIBRATE_KEPT_H
#define STAGES_CALIBRATE_KEPT_H
#include "sfm/views.h"

/* Before anything is read: removes what is not as the last run left it, and says so. */
bool kept_check(struct stage *stage, struct err *err);

/* Records what there is, so that a file that is missing or has changed is noticed. whole: with the database, behind everything;
 * while a run goes on that changes from moment to moment, and an interrupted one is gone on with as SQLite finds it sound. */
bool kept_record(struct stage *stage, const struct views *views, bool whole, struct err *err);

#endif
