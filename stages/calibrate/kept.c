#include "stages/calibrate/kept.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/record_holds.h"

static void say(void *ctx, const char *rel)
{
	stage_warn(ctx, "%s: not as the last run left it: made anew", rel);
}

bool kept_check(struct stage *stage, struct err *err)
{
	return record_drop_altered(stage->record, CALIBRATE_DIR, say, stage, err);
}

static void record_one(struct stage *stage, const char *name)
{
	char *rel = mem_printf(CALIBRATE_DIR "/%s", name);
	if (file_exists(stage_path(stage, "%s", rel)))
		record_made(stage->record, rel, 0, 0);
	free(rel);
}

bool kept_record(struct stage *stage, const struct views *views, bool whole, struct err *err)
{
	static const char *const kept[] = { "database.db", "options.txt", "pictures.json", "frames.json", "faces.json", "cloud.grid", "cloud.ply",
		                                "model/cameras.bin", "model/images.bin", "model/points3D.bin", "model/seal" };
	for (int i = whole ? 0 : 1; i < COUNT(kept); i++)
		record_one(stage, kept[i]);
	for (int i = 0; i < views->n_used; i++) {
		char *name = mem_printf("pictures/%s", views->v[i].picture);
		record_one(stage, name);
		free(name);
	}
	return record_save(stage->record, false, err);
}
