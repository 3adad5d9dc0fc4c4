/* skin: where skin and irises of a driven character will come from, as far as the configuration, names and the heads of files tell: its own materials, the
 * person in the video or in views/, or one colour. What the video shows of the person is known when it has been followed: render decides then, and says so in
 * work/render/NAME_skin.json.
 */
#ifndef PLAN_SKIN_H
#define PLAN_SKIN_H
#include "plan/decide.h"

struct plan_skin {
	char *file;        // "targets/a.obj"
	const char *from;  // "own", "video", "views" or "one colour"
	char *why;
};

/* Fills plan->skins, one for each character that is driven, and plan->iris, of all of them; none where no rig is made.
 * config_dir  folder that holds render.conf; null: the one beside the programs
 * conf        capture.conf and the command line
 * Returns false, err set, when render.conf cannot be read. plan_skins_free */
bool plan_skins(struct plan *plan, const char *config_dir, const struct conf *conf, struct err *err);
void plan_skins_free(struct plan *plan);

#endif
