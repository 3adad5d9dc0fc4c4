#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/version.h"
#include "plan.h"
#include "plan/skin.h"

/* Writes a file only when its bytes differ. */
static bool write_new(const char *path, const char *text, struct err *err)
{
	enum { LIMIT = 1 << 20 };
	char *was = 0;
	size_t size;
	struct err none = { 0 };
	bool same = file_read(&was, &size, path, LIMIT, &none) && !strcmp(was, text);
	free(was);
	return same || file_write(path, text, strlen(text), err);
}

static json_t *made_by(const struct plan *plan, const char *slice)
{
	json_t *config = json_object();
	for (const char *line = slice; *line;) {
		const char *end = strchrnul(line, '\n'), *eq = memmem(line, (size_t)(end - line), " = ", 3);
		if (eq) {
			char *key = mem_printf("%.*s", (int)(eq - line), line);
			json_object_set_new(config, key, json_stringn_nocheck(eq + 3, (size_t)(end - eq - 3)));
			free(key);
		}
		line = *end ? end + 1 : end;
	}
	return json_pack("{s:s,s:s,s:o,s:{s:s}}", "stage", "plan", "version", EYEWRIGHT_VERSION, "config", config,
	                 "inputs", "file names", plan->listing);
}

static bool write_json(const struct plan *plan, const char *slice, struct err *err)
{
	json_t *stages = json_array();
	for (int i = 0; i < PLAN_STAGES; i++) {
		const struct plan_row *row = &plan->rows[i];
		json_array_append_new(stages, json_pack("{s:s,s:b,s:s,s:f,s:f,s:s*}", "name", row->name, "run", row->run, "reason",
		                                        row->reason, "seconds", round(100 * row->seconds) / 100, "peak_mib", round(row->peak_mib), "setting", row->setting));
	}
	json_t *characters = json_array();
	for (int i = 0; i < plan->n_skins; i++) {
		const struct plan_skin *s = &plan->skins[i];
		json_t *file = json_string(s->file);
		json_array_append_new(characters, json_pack("{s:o,s:s,s:s}", "file", file ? file : json_string("(name is not UTF-8)"), "skin", s->from, "reason", s->why));
	}
	json_t *iris = plan->iris.why ? json_pack("{s:s,s:s}", "from", plan->iris.from, "reason", plan->iris.why) : 0;
	json_t *json = json_pack("{s:o,s:o,s:s*,s:o,s:o*}", "made_by", made_by(plan, slice), "stages", stages, "asked",
	                         *plan->asked ? plan->asked : 0, "characters", characters, "iris", iris);
	char *text = json_dumps(json, JSON_INDENT(1) | JSON_SORT_KEYS | JSON_REAL_PRECISION(6));
	char *path = mem_printf("%s/work/plan.json", plan->capture);
	bool ok = write_new(path, text, err);
	json_decref(json);
	free(text);
	free(path);
	return ok;
}

/* Writes a stage's rule; prerequisites: the stages it needs, for the last one all. Only names of the table are written: no text of
 * the folder's reaches make. */
static void write_rule(FILE *mk, const struct plan *plan, int i)
{
	const struct plan_row *row = &plan->rows[i];
	fprintf(mk, "%s:", row->name);
	if (!row->run) {
		fprintf(mk, "\n\t@echo \"%s does not run: %s\" >&2\n", row->name, row->reason);
		return;
	}
	for (int j = 1; j < i; j++)
		if (plan->rows[j].run && (i == PLAN_STAGES - 1 || plan_stage_needs(i, j)))
			fprintf(mk, " %s", plan->rows[j].name);
	// A stage without a record has never run: nobody needs to look.
	fprintf(mk, "\n\t@{ test -e \"$$CAPTURE/work/.made/%s.json\" && \"$$BIN/plan\" --capture=\"$$CAPTURE\" --fresh=%s; } || \\\n"
	            "\t\"$$BIN/%s\" --capture=\"$$CAPTURE\" $${THREADS:+\"--threads=$$THREADS\"}\n",
	        row->name, row->name, row->name);
}

/* What other programs get of the eye, without the pictures: a part of the last stage. */
static void write_export(FILE *mk, const struct plan *plan)
{
	const struct plan_row *relief = &plan->rows[plan_stage_find("relief")];
	if (relief->run)
		fprintf(mk, "export: relief refraction\n\t@\"$$BIN/render\" --capture=\"$$CAPTURE\" --only=export $${THREADS:+\"--threads=$$THREADS\"}\n");
	else
		fprintf(mk, "export:\n\t@echo \"export does not run: %s\" >&2\n", relief->reason);
}

static bool write_mk(const struct plan *plan, struct err *err)
{
	char *text = 0, *path = mem_printf("%s/work/plan.mk", plan->capture);
	size_t size = 0;
	FILE *mk = open_memstream(&text, &size);
	fputs("# Made by plan: which stages this folder needs. BIN: folder of the programs; CAPTURE: this folder.\n", mk);
	// A variable of make's command line is expanded again in each make below it: a dollar in the name would be lost.
	fputs("override CAPTURE := $(value CAPTURE)\nexport CAPTURE\n.PHONY: all", mk);
	for (int i = 1; i < PLAN_STAGES; i++)
		fprintf(mk, " %s", plan->rows[i].name);
	fputs(" export\nall:", mk);
	for (int i = 1; i < PLAN_STAGES; i++)
		if (plan->rows[i].run)
			fprintf(mk, " %s", plan->rows[i].name);
	fputs("\n", mk);
	if (plan->rows[PLAN_STAGES - 1].run)
		fputs("\t@printf '%s\\n' \"review page: $$CAPTURE/work/review/index.html\" 2>/dev/null || true\n", mk);
	for (int i = 1; i < PLAN_STAGES; i++)
		write_rule(mk, plan, i);
	write_export(mk, plan);
	fclose(mk);
	bool ok = write_new(path, text, err);
	free(text);
	free(path);
	return ok;
}

bool plan_write(const struct plan *plan, const char *slice, struct err *err)
{
	return write_json(plan, slice, err) && write_mk(plan, err);
}
