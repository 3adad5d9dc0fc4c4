#include "sfm/advice.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "sfm/colmap/db.h"
#include "sfm/colmap/db_matches.h"

/* Share of flat pairs above which the pictures show no depth. Measured: 0 to 0.03 on walks round a head, 1 from one place. */
static const double mostly_flat = 0.7;

bool advice_refuse(const struct views *views, struct stage *stage, struct err *err)
{
	struct db *db;
	int pairs = 0;
	long matches = 0;
	double flat = 0;
	if (!db_open(&db, stage_path(stage, CALIBRATE_DIR "/database.db"), err))
		return false;
	bool ok = db_checked(&pairs, &matches, db, 0, err) && db_flat_share(&flat, db, err);
	db_close(db);
	if (!ok)
		return false;
	if (!pairs)
		return err_set(err, "%s/views: no two of %d photographs show the same surface: walk round the head in steps of about 10 "
		               "degrees, the head filling the frame, in light that does not change", stage->capture, views->n_used);
	if (flat > mostly_flat)
		return err_set(err, "%s/views: the photographs overlap but show no depth: they seem to be taken from one place; walk round "
		               "the head instead of turning the camera", stage->capture);
	return err_set(err, "%s/views: the photographs overlap too little, or the person moved: take at least 8, in steps of about 10 "
	               "degrees, while the person sits still", stage->capture);
}

bool advice_is_flat(bool *flat, struct stage *stage, struct err *err)
{
	struct db *db;
	double share = 0;
	if (!db_open(&db, stage_path(stage, CALIBRATE_DIR "/database.db"), err))
		return false;
	bool ok = db_flat_share(&share, db, err);
	*flat = share > mostly_flat;
	db_close(db);
	return ok;
}

void advice_warn(const struct colmap_model *model, const struct views *views, struct stage *stage)
{
	// Of the median sharpness: pictures of one head in one light hardly differ by more.
	const double blurred = 0.25;
	double *sharp = mem_array((size_t)views->n_used + 1, sizeof *sharp);
	for (int i = 0; i < views->n_used; i++)
		sharp[i] = views->v[i].sharpness;
	double middle = stats_median(views->n_used, sharp);
	free(sharp);
	int frames = 0;
	for (int i = 0; i < views->n_used; i++) {
		const struct view *v = &views->v[i];
		bool registered = false;
		for (int k = 0; k < model->n_images; k++)
			registered |= !strcmp(model->images[k].name, v->picture);
		frames += !registered && v->frame >= 0;
		if (!registered && v->frame < 0)
			stage_skipped(stage, "%s: not registered: %s", v->file, v->sharpness < blurred * middle
			              ? "it is blurred" : "it shares too little with the others: take one between");
	}
	if (frames)
		stage_skipped(stage, "video: %d of its frames are not registered: they share too little with the other pictures", frames);
}
