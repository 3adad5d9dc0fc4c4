/* run: the COLMAP program, run as a child. Its output goes to work/calibrate/colmap.log; its progress is shown as `what`.
 * task  one of its commands ("mapper"); args: "--key", "value", ..., ended by a null pointer
 * All return false, err set, when the program is missing, cannot be started, or fails.
 */
#ifndef SFM_COLMAP_RUN_H
#define SFM_COLMAP_RUN_H
#include "base/stage.h"

/* Runs one task. total: steps that make it complete, for the progress; 0: none is shown but what COLMAP counts itself. */
bool colmap_run(struct stage *stage, const char *task, const char *const args[], int total, const char *what,
                struct err *err);

/* The same with work/calibrate as its current folder, to which paths among the arguments are relative: for tasks that keep files
 * of their own in the current folder, which need not be writable. */
bool colmap_run_inside(struct stage *stage, const char *task, const char *const args[], const char *what, struct err *err);

/* Runs the task n times, args[i] each, as many at a time as the stage has threads. */
bool colmap_run_parts(struct stage *stage, const char *task, int n, const char *const *const args[], const char *what,
                      struct err *err);

#endif
