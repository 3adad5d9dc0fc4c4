/* The character that stands for the others: on the interactive page, and round an eye that leaves alone. */
#include <string.h>

#include "base/mem.h"
#include "character/import.h"
#include "render/face/skin.h"

static const char *inside(struct stage *stage, const char *path)
{
	return path + strlen(stage->capture) + 1;
}

bool skin_first(struct skin_target *t, struct stage *stage, struct err *err)
{
	struct file_list list;
	*t = (struct skin_target){ 0 };
	if (!file_exists(stage_path(stage, "work/skin/model.json")))
		return true;
	if (!stage_list(stage, &list, "targets", err))
		return false;
	for (int i = 0; i < list.n && !t->name; i++) {
		if (character_kind_of(list.names[i]) == CHARACTER_NONE)
			continue;
		const char *dot = strrchr(list.names[i], '.');
		const char *name = inside(stage, stage_path(stage, "%.*s", dot ? (int)(dot - list.names[i]) : (int)strlen(list.names[i]), list.names[i]));
		const char *rig = stage_path(stage, "work/targets/%s/rig.npz", name), *look = stage_path(stage, "work/targets/%s/look.npz", name);
		if (!file_exists(rig))
			continue;
		t->name = name;
		t->in[t->n_in++] = t->rig_path = inside(stage, rig);
		t->in[t->n_in++] = "work/skin/model.json";
		if (file_exists(look))
			t->in[t->n_in++] = t->look_path = inside(stage, look);
	}
	file_list_free(&list);
	return true;
}
