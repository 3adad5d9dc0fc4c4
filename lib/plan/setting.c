#include "plan/setting.h"

#include <math.h>
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

/* A number of "key = value, key = value"; NAN where the key is not there. */
static double number_of(const char *settings, const char *key)
{
	const size_t n = strlen(key);
	for (const char *at = settings; (at = strstr(at, key)); at += n)
		if ((at == settings || at[-1] == ' ') && !strncmp(at + n, " = ", 3))
			return atof(at + n + 3);
	return NAN;
}

/* unrefract's key in capture.conf, else in a point's settings, else in its own configuration. */
static double unrefract_number(const char *key, const char *settings, const char *dir, const struct conf *conf, struct err *err)
{
	char *full = mem_printf("unrefract.%s", key), *path = mem_printf("%s/unrefract.conf", dir);
	const struct conf_item *own = conf_find(conf, full, 0), *quality = conf_find(conf, "quality", 0);
	double x = own && own->layer ? atof(own->value) : settings ? number_of(settings, key) : NAN;
	struct conf shipped = { 0 };
	if (!(x > 0) && conf_load(&shipped, path, "", 0, err)) {
		const struct conf_item *item = conf_find(&shipped, key, quality && *quality->value ? quality->value : "review");
		x = item ? atof(item->value) : NAN;
	}
	conf_free(&shipped);
	free(path);
	free(full);
	return x > 0 ? x : 1;
}

/* Million texels of the iris map. Before the limbus is known an iris map at scale 1 is taken to be as wide as MAP_SHARE of the photograph's
 * longer side: a close-up of 1600 px has 928. */
static double mtexel_of(const struct plan *plan, const char *settings, const char *dir, const struct conf *conf, struct err *err)
{
	static const double MAP_SHARE = 0.58, ASPECT = 4.0 / 3;
	const double mpx = plan->largest_mpx > 0 ? plan->largest_mpx : 2, longer = 1000 * sqrt(mpx * ASPECT);
	const double scale = unrefract_number("scale", settings, dir, conf, err), most = unrefract_number("max_size", settings, dir, conf, err);
	return 1e-6 * pow(fmin(most, scale * MAP_SHARE * longer), 2);
}

static void price(struct plan *plan, const struct plan_cost cost[PLAN_STAGES], const struct front *front, const int chosen[PLAN_STAGES])
{
	for (int i = 0; i < PLAN_STAGES; i++)
		if (plan->rows[i].run)
			plan->rows[i].seconds = chosen[i] >= 0 ? front_seconds(&front->points[chosen[i]], plan->mpx, plan->mtexel) : plan_cost_seconds(&cost[i], plan);
}

static double all_seconds(const struct plan *plan)
{
	double sum = 0;
	for (int i = 1; i < PLAN_STAGES; i++)
		sum += plan->rows[i].run ? plan->rows[i].seconds : 0;
	return sum;
}

/* Sets each row's setting; returns the line for the log: which points, their errors, seconds in all. free(). */
static char *tell(struct plan *plan, const struct front *front, const struct front_ask *ask, const int chosen[PLAN_STAGES])
{
	char *line = mem_printf("%s:", ask->text), *more;
	const double sum = all_seconds(plan);
	bool first = true;
	for (int i = 1; i < PLAN_STAGES; i++) {
		struct plan_row *row = &plan->rows[i];
		if (chosen[i] < 0)
			continue;
		const struct front_point *p = &front->points[chosen[i]];
		bool missed = ask->error && p->error > ask->value;
		row->setting = mem_printf("%s: %s (%.3g %s)", p->name, p->settings, p->error, p->unit);
		more = mem_printf("%s%s %s %s (%.2g %s%s)", line, first ? "" : ",", p->stage, p->name, p->error, p->unit,
		                  missed ? ", the best there is" : "");
		free(line);
		line = more;
		first = false;
	}
	bool late = ask->time && sum > ask->value;
	more = mem_printf("%s; about %.2g s in all%s", line, sum, late ? ", the least there is" : "");
	free(line);
	return more;
}

/* What a choice is worth: the sum of its errors' logarithms. */
static double log_errors(const struct front *front, const int chosen[PLAN_STAGES])
{
	double sum = 0;
	for (int i = 0; i < PLAN_STAGES; i++)
		sum += chosen[i] < 0 ? 0 : log(fmax(front->points[chosen[i]].error, 1e-9));
	return sum;
}

struct folder {
	const struct plan_cost *cost;
	const char *dir;
	const struct conf *conf;
};

/* Chooses with unrefract at one of its points, or, -1, as its preset has it; prices the plan so. */
static void choose_with(int point, struct plan *plan, const struct folder *f, const struct front *front, const struct front_ask *ask,
                        int chosen[PLAN_STAGES], struct err *err)
{
	const char *names[PLAN_STAGES];
	bool runs[PLAN_STAGES];
	double others_s = 0;
	plan->mtexel = mtexel_of(plan, point < 0 ? 0 : front->points[point].settings, f->dir, f->conf, err);
	for (int i = 0; i < PLAN_STAGES; i++) {
		const bool pinned = point >= 0 && !strcmp(plan_stages[i].name, "unrefract");
		names[i] = plan_stages[i].name;
		runs[i] = plan->rows[i].run && !pinned;
		if (pinned)
			others_s += front_seconds(&front->points[point], plan->mpx, plan->mtexel);
		else if (runs[i] && !has_front(front, names[i]))
			others_s += plan_cost_seconds(&f->cost[i], plan);
	}
	front_choose(front, ask, PLAN_STAGES, names, runs, plan->mpx, plan->mtexel, others_s, chosen);
	if (point >= 0)
		chosen[plan_stage_find("unrefract")] = point;
	price(plan, f->cost, front, chosen);
}

/* For a time: over unrefract's points, what keeps to it and is the most exact; where nothing keeps to it, the quickest. */
static void choose_for_time(struct plan *plan, const struct folder *f, const struct front *front, const struct front_ask *ask, int chosen[PLAN_STAGES],
                            struct err *err)
{
	int best = -1, some[PLAN_STAGES];
	double best_worth = 0, best_s = 0;
	for (int k = 0; k < front->n && plan->rows[plan_stage_find("unrefract")].run; k++) {
		if (strcmp(front->points[k].stage, "unrefract"))
			continue;
		choose_with(k, plan, f, front, ask, some, err);
		const double s = all_seconds(plan), worth = log_errors(front, some);
		const bool keeps = s <= ask->value, best_keeps = best >= 0 && best_s <= ask->value;
		if (best < 0 || (keeps ? !best_keeps || worth < best_worth : !best_keeps && s < best_s)) {
			best = k;
			best_s = s;
			best_worth = worth;
		}
	}
	choose_with(best, plan, f, front, ask, chosen, err);
}

static bool choose(struct plan_choice *choice, struct plan *plan, const struct folder *f, struct err *err)
{
	struct front *front = &choice->front;
	const struct front_ask *ask = &choice->ask;
	char *path = mem_printf("%s/fronts.conf", f->dir);
	bool ok = front_load(front, path, err);
	if (ok && ask->time)
		choose_for_time(plan, f, front, ask, choice->chosen, err);
	else if (ok) {
		choose_with(-1, plan, f, front, ask, choice->chosen, err);
		const int unrefract = choice->chosen[plan_stage_find("unrefract")];
		if (unrefract >= 0) {
			plan->mtexel = mtexel_of(plan, front->points[unrefract].settings, f->dir, f->conf, err);
			price(plan, f->cost, front, choice->chosen);
		}
	}
	if (ok && none_chosen(choice->chosen)) {
		char *known = units(front);
		ok = err_set(err, "%s/capture.conf: %s: no stage that runs here is measured in %s; %s has %s", plan->capture, ask->text, ask->unit, path, known);
		free(known);
	}
	free(path);
	return ok && !err_is(err);
}

bool plan_setting(struct plan_choice *choice, struct plan *plan, const struct plan_cost cost[PLAN_STAGES], const char *config_dir,
                  const struct conf *conf, struct err *err)
{
	char *dir = config_dir ? mem_str(config_dir) : call_config_dir();
	const struct folder f = { cost, dir, conf };
	*choice = (struct plan_choice){ 0 };
	bool ok = front_ask(&choice->ask, conf, err);
	if (ok && (choice->ask.error || choice->ask.time)) {
		ok = choose(choice, plan, &f, err);
		if (ok) {
			choice->line = tell(plan, &choice->front, &choice->ask, choice->chosen);
			snprintf(plan->asked, sizeof plan->asked, "%s", choice->ask.text);
		}
	} else if (ok) {
		int none[PLAN_STAGES];
		for (int i = 0; i < PLAN_STAGES; i++)
			none[i] = -1;
		plan->mtexel = mtexel_of(plan, 0, dir, conf, err);
		price(plan, cost, 0, none);
		ok = !err_is(err);
	}
	free(dir);
	return ok;
}

void plan_choice_free(struct plan_choice *choice)
{
	front_free(&choice->front);
	free(choice->line);
}
