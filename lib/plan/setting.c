#include "plan/setting.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/call.h"
#include "base/mem.h"

static bool has_front(const struct front *front, const char *stage)
{
	for (int i = 0; i < front->n; i++)
		if (!strcmp(front->points[i].stage, stage))
			return true;
	return false;
}

/* The units of the fronts, each once: "mm, %". free(). */
static char *units(const struct front *front)
{
	char *list = mem_str("");
	for (int i = 0; i < front->n; i++) {
		bool before = false;
		for (int j = 0; j < i && !before; j++)
			before = !strcmp(front->points[i].unit, front->points[j].unit);
		if (before)
			continue;
		char *more = mem_printf("%s%s%s", list, *list ? ", " : "", front->points[i].unit);
		free(list);
		list = more;
	}
	return list;
}

static bool none_chosen(const int chosen[PLAN_STAGES])
{
	for (int i = 0; i < PLAN_STAGES; i++)
		if (chosen[i] >= 0)
			return false;
	return true;
}

/* Sets each row's setting and seconds; returns the line for the log: which points, their errors, seconds in all. free(). */
static char *tell(struct plan *plan, const struct front *front, const struct front_ask *ask, const int chosen[PLAN_STAGES])
{
	char *line = mem_printf("%s:", ask->text), *more;
	double sum = 0;
	bool first = true;
	for (int i = 1; i < PLAN_STAGES; i++) {
		struct plan_row *row = &plan->rows[i];
		if (chosen[i] >= 0) {
			const struct front_point *p = &front->points[chosen[i]];
			bool missed = ask->error && p->error > ask->value;
			row->seconds = front_seconds(p, plan->mpx);
			row->setting = mem_printf("%s: %s (%.3g %s)", p->name, p->settings, p->error, p->unit);
			more = mem_printf("%s%s %s %s (%.2g %s%s)", line, first ? "" : ",", p->stage, p->name, p->error, p->unit,
			                  missed ? ", the best there is" : "");
			free(line);
			line = more;
			first = false;
		}
		sum += row->seconds;
	}
	bool late = ask->time && sum > ask->value;
	more = mem_printf("%s; about %.2g s in all%s", line, sum, late ? ", the least there is" : "");
	free(line);
	return more;
}

bool plan_setting(struct plan_choice *choice, struct plan *plan, const char *config_dir, const struct conf *conf, struct err *err)
{
	struct front *front = &choice->front;
	const struct front_ask *ask = &choice->ask;
	const char *names[PLAN_STAGES];
	bool runs[PLAN_STAGES];
	double others_s = 0;
	*choice = (struct plan_choice){ 0 };
	if (!front_ask(&choice->ask, conf, err) || (!ask->error && !ask->time))
		return !err_is(err);
	char *dir = config_dir ? mem_str(config_dir) : call_config_dir(), *path = mem_printf("%s/fronts.conf", dir);
	bool ok = front_load(front, path, err);
	for (int i = 0; i < PLAN_STAGES; i++) {
		names[i] = plan_stages[i].name;
		runs[i] = plan->rows[i].run;
		others_s += has_front(front, names[i]) ? 0 : plan->rows[i].seconds;
	}
	if (ok) {
		front_choose(front, ask, PLAN_STAGES, names, runs, plan->mpx, others_s, choice->chosen);
		if (none_chosen(choice->chosen)) {
			char *known = units(front);
			ok = err_set(err, "%s/capture.conf: %s: no stage that runs here is measured in %s; %s has %s", plan->capture, ask->text,
			             ask->unit, path, known);
			free(known);
		}
	}
	if (ok) {
		choice->line = tell(plan, front, ask, choice->chosen);
		snprintf(plan->asked, sizeof plan->asked, "%s", ask->text);
	}
	free(dir);
	free(path);
	return ok;
}

void plan_choice_free(struct plan_choice *choice)
{
	front_free(&choice->front);
	free(choice->line);
}
