#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/template.h"
#include "summary.h"

enum { DEEPEST = 4, LONGEST = 16, MOST = 256, KEY_MOST = 80, TEXT_MOST = 400 };

/* Keys become columns: those of programs are plain. */
static bool is_plain(const char *key)
{
	const size_t n = strlen(key);
	return n && n <= KEY_MOST && strspn(key, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.") == n;
}

static void put(json_t *record, const char *key, const json_t *value)
{
	json_t *numbers = json_object_get(record, "numbers"), *texts = json_object_get(record, "texts");
	if (!is_plain(key))
		return;
	if ((json_is_number(value) || json_is_boolean(value)) && json_object_size(numbers) < MOST)
		json_object_set_new(numbers, key, json_is_number(value) ? json_real(json_number_value(value)) : json_integer(json_is_true(value)));
	else if (json_is_string(value) && json_string_length(value) && json_object_size(texts) < MOST) {
		char *cut = mem_printf("%.*s", TEXT_MOST, json_string_value(value));
		json_object_set_new(texts, key, template_text(cut));  // a cut letter is written by its bytes
		free(cut);
	}
}

static void flatten(json_t *record, const char *key, const json_t *value, int depth)
{
	const char *of, *dot = *key ? "." : "";
	const json_t *item;
	size_t i;
	if (json_is_array(value) && json_array_size(value) <= LONGEST && depth < DEEPEST)
		json_array_foreach(value, i, item) {
			char *more = mem_printf("%s.%zu", key, i);
			if (!json_is_object(item) && !json_is_array(item))
				put(record, more, item);
			free(more);
		}
	else if (json_is_object(value) && depth < DEEPEST)
		json_object_foreach((json_t *)value, of, item) {
			char *more = mem_printf("%s%s%s", key, dot, of);
			if (depth || strcmp(of, "made_by"))
				flatten(record, more, item, depth + 1);
			free(more);
		}
	else
		put(record, key, value);
}

void record_add(json_t *records, const char *part, const char *of, const json_t *object)
{
	json_t *record = json_pack("{s:s,s:o,s:{},s:{}}", "part", part, "of", template_text(of), "numbers", "texts");
	flatten(record, "", object, 0);
	json_array_append_new(records, record);
}

double record_number(const json_t *record, const char *key)
{
	const json_t *value = json_object_get(json_object_get(record, "numbers"), key);
	return json_is_number(value) ? json_number_value(value) : NAN;
}

const char *record_text(const json_t *record, const char *key)
{
	const json_t *value = json_object_get(json_object_get(record, "texts"), key);
	return json_is_string(value) ? json_string_value(value) : "";
}

json_t *records_checked(const json_t *given)
{
	json_t *records = json_array();
	const json_t *record, *value;
	const char *key;
	size_t i;
	json_array_foreach(given, i, record) {
		const char *part = json_string_value(json_object_get(record, "part")), *of = json_string_value(json_object_get(record, "of"));
		if (!part || !of || !is_plain(part))
			continue;
		json_t *taken = json_pack("{s:s,s:s,s:{},s:{}}", "part", part, "of", of, "numbers", "texts");
		json_object_foreach(json_object_get(record, "numbers"), key, value)
			put(taken, key, value);
		json_object_foreach(json_object_get(record, "texts"), key, value)
			put(taken, key, value);
		json_array_append_new(records, taken);
	}
	return records;
}
