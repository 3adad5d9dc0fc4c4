/* Time, error and figures of every stage, what was left out and why. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "plan/stages.h"
#include "render/page/page.h"

/* setting: of a measured front, where capture.conf asks for an error or a time; or null. */
static json_t *plan_reason(const json_t *plan, const char *name, bool *run, json_t **setting)
{
	json_t *stages = json_object_get(plan, "stages"), *row;
	size_t i;
	json_array_foreach(stages, i, row) {
		const char *is = json_string_value(json_object_get(row, "name"));
		if (is && !strcmp(is, name)) {
			*run = json_is_true(json_object_get(row, "run"));
			*setting = json_object_get(row, "setting");
			return json_object_get(row, "reason");
		}
	}
	*run = true;
	return 0;
}

static json_t *sentences(const json_t *lines)
{
	json_t *list = json_array(), *line;
	size_t i;
	json_array_foreach(lines, i, line)
		if (json_is_string(line))
			json_array_append_new(list, page_sentence(json_string_value(line)));
	return list;
}

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static json_t *row(struct page *page, const char *name, const json_t *plan, json_t *log, double *seconds)
{
	bool run, self = !strcmp(name, "render");
	json_t *setting = 0, *reason = plan_reason(plan, name, &run, &setting), *entry = json_pack("{s:s}", "name", name);
	const char *error = json_string_value(json_object_get(log, "error"));
	if (json_is_string(reason))
		json_object_set_new(entry, "reason", page_sentence(json_string_value(reason)));
	if (json_is_string(setting) && run)
		json_object_set_new(entry, "setting", page_sentence(json_string_value(setting)));
	if (!log && !self) {
		bool planned = plan && reason && !strcmp(name, plan_stages[0].name);  // plan keeps no log: what it wrote is there
		if (planned)
			json_object_set(entry, "note", json_object_get(entry, "reason"));
		else
			json_object_set_new(entry, "idle", json_true());
		return entry;
	}
	// render itself has no log yet: its time so far.
	double s = self ? now_s() - page->stage->start_s : json_number_value(json_object_get(log, "seconds"));
	*seconds += s;
	json_object_set_new(entry, "time", json_real(s));
	json_object_set_new(entry, "seconds", page_text("%.2f", s));
	json_object_set_new(entry, "figures", page_facts(log));
	json_object_set_new(entry, "skips", sentences(json_object_get(log, "skipped")));
	if (error && *error)
		json_object_set_new(entry, "error", page_sentence(error));
	return entry;
}

/* Each stage's share of the time, for a bar. */
static void shares(json_t *list)
{
	double most = 1e-9;
	size_t i;
	json_t *entry;
	json_array_foreach(list, i, entry)
		most = fmax(most, json_number_value(json_object_get(entry, "time")));
	json_array_foreach(list, i, entry)
		json_object_set_new(entry, "share", json_real(100 * json_number_value(json_object_get(entry, "time")) / most));
}

json_t *page_stages(struct page *page, double *seconds)
{
	json_t *list = json_array(), *plan = page_json(page, page_file(page, "work/plan.json"));
	*seconds = 0;
	for (int i = 0; i < PLAN_STAGES; i++) {
		const char *name = plan_stages[i].name;
		json_t *log = strcmp(name, "render") ? page_json(page, page_file(page, "work/log/%s.json", name)) : 0;
		json_array_append_new(list, row(page, name, plan, log, seconds));
		json_decref(log);
	}
	json_decref(plan);
	shares(list);
	return list;
}
