/* The cameras found from views/, and the mesh made with them. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/page/page.h"

enum { WIDTH = 1120 };

/* Characters registered to the mesh, where there is no video: those that are driven have a section of their own. */
static json_t *laid_on(struct page *page)
{
	json_t *list = json_array();
	struct file_list targets;
	struct err err = { 0 };
	if (page_file(page, "work/skin/model.json") || page_file(page, "work/skin/gaze.csv")
	    || !stage_list(page->stage, &targets, "targets", &err))
		return list;
	for (int i = 0; i < targets.n; i++) {
		const char *dot = strrchr(targets.names[i], '.');
		char *name = mem_printf("%.*s", dot ? (int)(dot - targets.names[i]) : (int)strlen(targets.names[i]), targets.names[i]);
		json_t *picture = page_picture(page, page_file(page, "work/targets/%s/registration.png", name), WIDTH);
		if (picture)
			json_array_append_new(list, json_pack("{s:o,s:o}", "name", template_text(name), "picture", picture));
		free(name);
	}
	file_list_free(&targets);
	return list;
}

json_t *page_rig(struct page *page)
{
	json_t *picture = page_picture(page, page_file(page, "work/calibrate/rig.png"), WIDTH), *line;
	json_t *log = page_json(page, page_file(page, "work/log/calibrate.json")), *skipped = json_array();
	size_t i;
	json_array_foreach(json_object_get(log, "skipped"), i, line)
		if (json_is_string(line))
			json_array_append_new(skipped, page_sentence(json_string_value(line)));
	json_t *rig = picture ? json_pack("{s:o,s:o,s:o,s:o}", "picture", picture, "facts", page_facts(log), "skipped", json_incref(skipped), "laid",
	                                    laid_on(page)) : 0;
	json_decref(skipped);
	json_decref(log);
	return rig;
}
