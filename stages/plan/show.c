#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/record_holds.h"
#include "plan.h"
#include "plan/skin.h"

bool plan_fresh(bool *fresh, char **why, const struct call *call, const char *stage, struct err *err)
{
	struct conf conf = { 0 };
	*fresh = false;
	*why = 0;
	if (plan_stage_find(stage) < 0)
		return err_usage(err, "--fresh = %.60s: no such stage", stage);
	bool ok = call_load(call, stage, &conf, err);
	if (ok) {
		char *program = plan_stage_program(stage);
		*fresh = record_holds(call->capture, stage, program, &conf, why);
		free(program);
	}
	conf_free(&conf);
	return ok;
}

/* Whether row i has to run: its last run does not hold, or cannot be looked into. */
static bool has_to_run(const struct plan *plan, const struct call *call, int i)
{
	struct err err = { 0 };
	bool fresh = true;
	char *why = 0;
	if (plan->rows[i].run && !plan_fresh(&fresh, &why, call, plan->rows[i].name, &err))
		fresh = false;
	free(why);
	return !fresh;
}

bool plan_all_fresh(const struct plan *plan, const struct call *call)
{
	for (int i = 1; i < PLAN_STAGES; i++)
		if (has_to_run(plan, call, i))
			return false;
	return true;
}

bool plan_request(const struct plan *plan, const struct call *call)
{
	bool runs[PLAN_STAGES] = { 0 }, any = false;
	for (int i = 1; i < PLAN_STAGES; i++) {
		const struct plan_row *row = &plan->rows[i];
		runs[i] = has_to_run(plan, call, i);
		// Behind a stage that runs the inputs are not known yet. The last takes them from all.
		for (int j = 1; j < i && row->run; j++)
			runs[i] |= runs[j] && (i == PLAN_STAGES - 1 || plan_stage_needs(i, j));
		if (runs[i])
			printf("%s\t%.1f\t%.0f\n", row->name, row->seconds, row->peak_mib);
		any |= runs[i];
	}
	return !any;
}

/* Seconds the stage took last time; negative when it left no log. */
static double seconds_taken(const char *capture, const char *stage)
{
	char *path = mem_printf("%s/work/log/%s.json", capture, stage);
	json_t *log = json_load_file(path, 0, 0), *seconds = json_object_get(log, "seconds");
	double s = seconds ? json_number_value(seconds) : -1;
	json_decref(log);
	free(path);
	return s;
}

void plan_show(const struct plan *plan, const struct call *call)
{
	double sum = 0, peak = 0;
	printf("%-12s %-11s %9s %9s %9s  %s\n", "stage", "", "estimate", "last run", "memory", "why");
	for (int i = 1; i < PLAN_STAGES; i++) {
		const struct plan_row *row = &plan->rows[i];
		struct err err = { 0 };
		bool fresh = false;
		char *why = 0, last[32] = "-";
		if (row->run && !plan_fresh(&fresh, &why, call, row->name, &err))
			why = mem_str(err.msg);
		double took = seconds_taken(plan->capture, row->name);
		if (took >= 0)
			snprintf(last, sizeof last, "%.2f s", took);
		printf("%-12s %-11s ", row->name, !row->run ? "skip" : fresh ? "up to date" : "run");
		if (row->run)
			printf("%7.2f s %9s %5.0f MiB  %s%s%s%s%s%s\n", row->seconds, last, row->peak_mib, row->reason, why ? " (" : "", why ? why : "", why ? ")" : "",
			       row->setting ? "; " : "", row->setting ? row->setting : "");
		else
			printf("%9s %9s %9s  %s\n", "-", "-", "-", row->reason);
		sum += fresh ? 0 : row->seconds;
		peak = fmax(peak, fresh ? 0 : row->peak_mib);
		free(why);
	}
	if (*plan->asked)
		printf("%s: settings from the measured fronts, config/fronts.conf\n", plan->asked);
	if (plan->n_photos)
		printf("photographs: %d, %.1f megapixels\n", plan->n_photos, plan->mpx);
	if (plan->kframes > 0)
		printf("video: %.0f frames\n", 1e3 * plan->kframes);
	if (plan->n_characters)
		printf("characters: %d\n", plan->n_characters);
	for (int i = 0; i < plan->n_skins; i++) {
		const struct plan_skin *s = &plan->skins[i];
		fputs("skin of ", stdout);
		for (const char *c = s->file; *c; c++)
			putchar((unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c);
		printf(": %s: %s\n", !strcmp(s->from, "own") ? "its own" : !strcmp(s->from, "video") ? "the person's in the video" : !strcmp(s->from, "views") ? "the person's in views/" : s->from,
		       s->why);
	}
	if (plan->iris.why)
		printf("irises of characters: %s: %s\n", !strcmp(plan->iris.from, "video") ? "the person's in the video" : !strcmp(plan->iris.from, "drawn") ? "drawn" : "those of photos/", plan->iris.why);
	if (sum > 0)
		printf("about %.1f s to do, in %.0f MiB of memory\n", sum, peak);
	else
		printf("nothing to do\n");
}
