/* mapper: one run of COLMAP's incremental mapper: cameras and points from the verified matches of the database.
 */
#ifndef SFM_MAPPER_H
#define SFM_MAPPER_H
#include "sfm/views.h"

/* Folders are relative to the capture. */
struct mapper_step {
	const char *from;   // a model to go on with; null: begins from the matches alone
	const char *to;     // where the models are written: to/0, to/1 ...; one that was gone on with: to itself
	bool fixed;         // the cameras of that model stay where they are
	bool refine;        // focal length and distortion are adjusted
	bool adjust_each;   // a global bundle adjustment with each picture that comes, not now and then
};

/* Runs the mapper on one thread, so that its sums do not depend on how many there are. Returns false, err set, when COLMAP
 * fails; it calls that a failure, too, when no pair of pictures is fit to begin with. */
bool mapper_run(struct stage *stage, const struct views *views, const struct mapper_step *step, const struct calibrate_options *o,
                struct err *err);

/* Removes a model's files and then its folder, which is relative to the capture. What is missing is no error. */
void mapper_remove(struct stage *stage, const char *dir);

#endif
