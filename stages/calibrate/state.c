#include "stages/calibrate/state.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/colmap/db.h"
#include "sfm/mapper.h"
#include "sfm/model.h"

#define STATE CALIBRATE_DIR "/options.txt"

static char *matching_text(const struct calibrate_options *o)
{
	const struct sfm_overlap_conf *p = &o->overlap;
	return mem_printf("matching: %d px, %d features, octave %d; %d %d %d %d %.9g %.9g %d\n", o->picture_px, o->features,
	                  o->first_octave, p->strongest, p->min_matches, p->always, o->sequence_neighbours, p->match.max_ratio,
	                  p->match.max_distance, o->min_matches);
}

static char *mapping_text(const struct calibrate_options *o)
{
	return mem_printf("mapping: %d %.9g %.9g %d %.9g %.9g %.9g\n", o->lens, o->filter_px, o->tri_deg, o->ba_rounds, o->camera.focal_px,
	                  o->camera.focal_mm, o->camera.sensor_mm);
}

bool state_check(struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	enum { LIMIT = 4096 };
	char *was = 0, *matching = matching_text(o), *mapping = mapping_text(o);
	size_t size;
	struct err none = { 0 };
	if (!file_read(&was, &size, stage_path(stage, STATE), LIMIT, &none))
		was = mem_str("");
	bool ok = true, matches = !stage->force && strstr(was, matching), maps = matches && strstr(was, mapping);
	if (!matches)
		ok = db_remove(stage_path(stage, CALIBRATE_DIR "/database.db"), err);
	if (!maps)
		mapper_remove(stage, MODEL_DIR);
	free(was);
	free(matching);
	free(mapping);
	return ok;
}

bool state_save(struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	char *matching = matching_text(o), *mapping = mapping_text(o), *text = mem_printf("%s%s", matching, mapping);
	bool ok = file_write(stage_path(stage, STATE), text, strlen(text), err);
	free(matching);
	free(mapping);
	free(text);
	return ok;
}
