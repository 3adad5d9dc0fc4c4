#include "plan/stages.h"

#include <string.h>
#include <stdlib.h>

#include "base/call.h"
#include "base/mem.h"

const struct plan_stage plan_stages[] = {
	{ .name = "plan", .does = "decides what the others do", .without = "" },
	{ .name = "calibrate",
	  .any = HAS_VIEWS | HAS_VIDEO,
	  .does = "cameras from the overlapping views, or from the video",
	  .without = "one photograph or no views/: cameras come from EXIF or capture.conf" },
	{ .name = "limbus", .takes_cameras = true, .any = HAS_PHOTOS, .does = "finds the eye in each photograph", .without = "no photos/" },
	{ .name = "unrefract", .needs = "limbus", .any = HAS_PHOTOS, .does = "takes the cornea off the iris", .without = "no photos/" },
	{ .name = "freckles", .needs = "unrefract", .any = HAS_PHOTOS, .does = "finds and fills freckles of the iris", .without = "no photos/" },
	{ .name = "heightfield", .needs = "freckles", .any = HAS_PHOTOS, .does = "coarse thickness of the stroma", .without = "no photos/" },
	{ .name = "pigment", .needs = "heightfield", .any = HAS_PHOTOS, .does = "melanin of the iris", .without = "no photos/" },
	{ .name = "relief", .needs = "pigment", .any = HAS_PHOTOS, .does = "relief that renders like the photograph", .without = "no photos/" },
	{ .name = "refraction", .needs = "unrefract", .any = HAS_PHOTOS, .does = "how light reaches the iris", .without = "no photos/" },
	{ .name = "track",
	  .title = "Tracked",
	  .takes_cameras = true,
	  .any = HAS_VIDEO,
	  .does = "follows gaze, lids and skin",
	  .without = "no video/: there is no motion to follow" },
	{ .name = "train",
	  .title = "Learnt",
	  .needs = "track",
	  .any = HAS_VIDEO,
	  .does = "learns how the skin moves with the eye",
	  .without = "no video/: there is no motion to learn" },
	{ .name = "transfer",
	  .title = "Registered",
	  .needs = "train",
	  .takes_cameras = true,
	  .any = HAS_TARGETS,
	  .all = HAS_VIDEO,
	  .does = "fits the characters to the subject",
	  .without = "no targets/, or neither video/ to learn from nor views/ to make the subject's mesh from",
	  .other = { { "calibrate", HAS_VIEWS | HAS_TARGETS } } },
	{ .name = "extrapolate",
	  .title = "Rigged",
	  .needs = "transfer",
	  .any = HAS_TARGETS,
	  .all = HAS_VIDEO,
	  .does = "rigs the characters",
	  .without = "no targets/, or no video/ to learn from" },
	{ .name = "animate",
	  .title = "Animated",
	  .needs = "train",
	  .any = HAS_SCRIPT,
	  .all = HAS_VIDEO,
	  .does = "moves the eyes as script/ says",
	  .without = "no script/, or no video/ to learn from" },
	{ .name = "render",
	  .needs = "relief",
	  .any = HAS_PHOTOS,
	  .does = "pictures and the review page",
	  .without = "neither photos/ of an eye, nor views/, nor video/ to show",
	  .other = { { "extrapolate", HAS_VIDEO | HAS_TARGETS }, { "calibrate", HAS_VIEWS }, { "track", HAS_VIDEO } } },
};
_Static_assert(sizeof plan_stages / sizeof *plan_stages == PLAN_STAGES, "PLAN_STAGES counts the table's rows");

int plan_stage_find(const char *name)
{
	for (int i = 0; i < PLAN_STAGES; i++)
		if (!strcmp(plan_stages[i].name, name))
			return i;
	return -1;
}

bool plan_stage_needs(int i, int j)
{
	const struct plan_stage *s = &plan_stages[i];
	return (s->takes_cameras && !strcmp(plan_stages[j].name, "calibrate")) || (s->needs && !strcmp(s->needs, plan_stages[j].name));
}

char *plan_stage_program(const char *name)
{
	char *self = call_program_path(), *slash = strrchr(self, '/');
	char *path = mem_printf("%.*s%s", slash ? (int)(slash - self + 1) : 0, self, name);
	free(self);
	return path;
}
