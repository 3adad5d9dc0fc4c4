#include "render/page/page.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"

static char *format(const char *fmt, va_list ap)
{
	char *text = 0;
	return vasprintf(&text, fmt, ap) < 0 ? mem_str("") : text;
}

const char *page_file(struct page *page, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	char *rel = format(fmt, ap);
	va_end(ap);
	const char *path = stage_path(page->stage, "%s", rel);
	free(rel);
	return file_exists(path) ? path : 0;
}

json_t *page_json(struct page *page, const char *path)
{
	struct err err = { 0 };
	json_t *root = path ? json_read(path, 1 << 24, &err) : 0;
	if (path && !root)
		page_say(page->missing, "%s", err.msg);
	return root;
}

json_t *page_text(const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	char *text = format(fmt, ap);
	va_end(ap);
	json_t *json = template_text(text);
	free(text);
	return json;
}

json_t *page_facts(const json_t *log)
{
	json_t *list = json_array(), *value;
	const char *key;
	json_object_foreach(json_object_get(log, "figures"), key, value)
		json_array_append_new(list, page_figure(key, json_number_value(json_object_get(value, "value")), json_string_value(json_object_get(value, "unit"))));
	return list;
}

void page_say(json_t *list, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	char *text = format(fmt, ap);
	va_end(ap);
	json_t *line = page_sentence(text), *old;
	size_t i;
	free(text);
	json_array_foreach(list, i, old)
		if (json_equal(line, old)) {
			json_decref(line);
			return;
		}
	json_array_append_new(list, line);
}
