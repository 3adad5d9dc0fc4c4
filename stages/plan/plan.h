/* plan: what the program does with a plan (lib/plan): writes it, prints it, checks what the last runs left. */
#ifndef STAGES_PLAN_PLAN_H
#define STAGES_PLAN_PLAN_H
#include "base/call.h"
#include "plan/decide.h"

/* What is asked for beside planning: not part of the configuration, so not in the option table. */
struct plan_asked {
	bool show, clean, todo;
	const char *fresh;
};

/* work/plan.json and work/plan.mk. slice: opt_print's lines of plan's own configuration. */
bool plan_write(const struct plan *plan, const char *slice, struct err *err);

/* The table people read, to stdout. */
void plan_show(const struct plan *plan, const struct call *call);

/* Whether the last run of every stage that the folder needs still holds. */
bool plan_all_fresh(const struct plan *plan, const struct call *call);

/* Whether that stage's last run still holds. False, err set, for a stage nobody knows. */
bool plan_fresh(bool *fresh, char **why, const struct call *call, const char *stage, struct err *err);

/* Every stage's keys of capture.conf against that stage's own table, before the first of them starts. What has
 * been found good is remembered by its bytes. False: the stage has already said why. */
bool plan_check_conf(const struct plan *plan, const struct conf *conf, struct err *err);

/* Removes work/, never what a link leads to. */
bool plan_clean(const char *capture, struct err *err);

/* Does what is asked, prints what is wrong; exit status. opts: cost's rows, conf: what the command line says. */
int plan_run(const struct call *call, const struct plan_asked *asked, const struct opt opts[PLAN_STAGES],
             const struct plan_cost cost[PLAN_STAGES], struct conf *conf, struct err *err);

#endif
