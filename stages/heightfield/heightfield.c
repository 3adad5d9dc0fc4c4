#include "heightfield.h"

#include <stdlib.h>

#include "base/mem.h"
#include "image/exr.h"

enum { MAP_LIMIT_PX = 1 << 26 };
static const char *const rgbw[] = { "R", "G", "B", "W" };
static const char *const channels[] = { "Y", "S" };

static void report(struct stage *stage, const struct capture_eye *eye, const struct heightfield_result *r)
{
	stage_note(stage, "%s: thickness %.3f mm (%.3f to %.3f), detail %.0f %% rms, %.0f %% of the iris seen", eye->side, r->mean,
	           r->low, r->high, 100 * r->detail_rms, 100 * r->seen);
	stage_figure(stage, "thickness_mean", r->mean, "mm");
	stage_figure(stage, "detail_rms", 100 * r->detail_rms, "%");
	stage_figure(stage, "iris_seen", 100 * r->seen, "%");
	if (r->seen < 0.6)
		stage_skipped(stage, "%s: %.0f %% of the iris was hidden: its thickness there is the generic profile. "
		              "Photograph it with the lids held open", eye->side, 100 * (1 - r->seen));
}

bool heightfield_stage(struct stage *stage, const struct capture_eye *eye, const struct eye *anatomy,
                       const struct heightfield_stage_conf *conf, struct err *err)
{
	char *clean_rel = mem_printf("%s/clean.exr", eye->iris), *texture_rel = mem_printf("%s/texture.json", eye->iris);
	char *out = mem_printf("%s/thickness.exr", eye->iris);
	const char *const in[] = { clean_rel, texture_rel };
	struct image clean = { 0 };
	struct exr_info info = { 0 };
	struct pupil pupil;
	struct heightfield_result result = { 0 };
	bool ok = stage_fresh(stage, out, COUNT(in), in);
	if (!ok) {
		ok = exr_read(&clean, stage_path(stage, "%s", clean_rel), 4, rgbw, MAP_LIMIT_PX, &info, err)
		     && pupil_load(&pupil, stage_path(stage, "%s", texture_rel), conf->pupil_radius, err)
		     && heightfield_run(&result, &clean, info.extent_mm, &pupil, anatomy->limbus_radius, &conf->field, err);
		info.made_by = stage_made_by(stage, COUNT(in), in);
		ok = ok && exr_write(stage_path(stage, "%s", out), &result.map, channels, EXR_HALF, &info, err)
		     && stage_made(stage, out, COUNT(in), in, err);
		if (ok)
			report(stage, eye, &result);
	}
	image_free(&clean);
	image_free(&result.map);
	free(clean_rel);
	free(texture_rel);
	free(out);
	return ok;
}
