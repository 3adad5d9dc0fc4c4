/* The cameras found from views/, and the mesh made with them. */
#include <stdlib.h>

#include "base/mem.h"
#include "render/page.h"

static json_t *facts(json_t *log)
{
	json_t *list = json_array(), *value;
	const char *key;
	json_object_foreach(json_object_get(log, "figures"), key, value) {
		const char *unit = json_string_value(json_object_get(value, "unit"));
		char *label = mem_str(key);
		for (char *p = label; *p; p++)
			*p = *p == '_' ? ' ' : *p;
		json_array_append_new(list, json_pack("{s:o,s:o}", "label", template_text(label), "value",
		                                      page_text("%.6g %s", json_number_value(json_object_get(value, "value")), unit ? unit : "")));
		free(label);
	}
	return list;
}

json_t *page_rig(struct page *page)
{
	enum { WIDTH = 1120 };
	json_t *picture = page_picture(page, page_file(page, "work/calibrate/rig.png"), WIDTH), *line;
	json_t *log = page_json(page, page_file(page, "work/log/calibrate.json")), *skipped = json_array();
	size_t i;
	json_array_foreach(json_object_get(log, "skipped"), i, line)
		if (json_is_string(line))
			json_array_append(skipped, line);
	json_t *rig = picture ? json_pack("{s:o,s:o,s:o}", "picture", picture, "facts", facts(log), "skipped", json_incref(skipped)) : 0;
	json_decref(skipped);
	json_decref(log);
	return rig;
}
