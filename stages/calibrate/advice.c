/* What went wrong with the photographs, in words of photography. */
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "stages/calibrate/db.h"
#include "stages/calibrate/model.h"

bool model_advice(const struct views *views, struct stage *stage, struct err *err)
{
	struct db *db;
	int pairs = 0;
	long matches = 0;
	if (!db_open(&db, stage_path(stage, CALIBRATE_DIR "/database.db"), err))
		return false;
	bool ok = db_checked(&pairs, &matches, db, 0, err);
	db_close(db);
	if (!ok)
		return false;
	if (!pairs)
		return err_set(err, "%s/views: no two of %d photographs show the same surface: walk round the head in steps of about 10 "
		               "degrees, the head filling the frame, in light that does not change", stage->capture, views->n_used);
	if (views->n_used < 3)
		return err_set(err, "%s/views: two photographs do not tell cameras from shape: take at least 8, from all round",
		               stage->capture);
	return err_set(err, "%s/views: the photographs overlap but show no depth: they seem to be taken from one place; walk round "
	               "the head instead of turning the camera, and let the person sit still", stage->capture);
}
