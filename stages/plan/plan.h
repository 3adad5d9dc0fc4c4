/* plan: what the program does with a plan (lib/plan): writes it, prints it, checks what the last runs left. */
#ifndef STAGES_PLAN_PLAN_H
#define STAGES_PLAN_PLAN_H
#include "base/call.h"
#include "plan/decide.h"

/* Rows of plan's configuration: seconds and memory of each stage. */
enum { PLAN_OPTS = 2 * PLAN_STAGES };

/* Options of the command line beside planning: --show, --clean, --todo, --request, --requests, --fresh=STAGE. They are no part of the
 * configuration, so they are not in the option table. */
struct plan_asked {
	bool show, clean, todo, request, requests;
	const char *fresh;
};

/* Writes work/plan.json and work/plan.mk where their bytes change. slice: opt_print's lines of plan's own configuration. */
bool plan_write(const struct plan *plan, const char *slice, struct err *err);

/* Prints the table for people to stdout. */
void plan_show(const struct plan *plan, const struct call *call);

/* Prints what each stage that has to run will need, for a scheduler: its name, seconds, MiB, tabs between. Returns true when there is
 * none. */
bool plan_request(const struct plan *plan, const struct call *call);

/* True when the last run of every stage that the folder needs still holds (base/record_holds.h). */
bool plan_all_fresh(const struct plan *plan, const struct call *call);

/* fresh: out, whether that stage's last run still holds. why: out, what does not hold, or null; free(). Returns false, err set, for an
 * unknown stage or a configuration that cannot be read. */
bool plan_fresh(bool *fresh, char **why, const struct call *call, const char *stage, struct err *err);

/* Has every stage that runs check its keys of capture.conf (STAGE --print-config), before the first of them starts. A configuration
 * that was found good is remembered by a hash. Returns false, err set to the stage's own message. */
bool plan_check_conf(const struct plan *plan, const struct conf *conf, struct err *err);

/* Puts aside what stages that the folder does not need any more have made of files that are gone (base/record_leave.h), so that nobody takes it
 * for its own, and says so unless quiet; brings back what stages have that it needs again. To be called with work/ locked. */
bool plan_move(const struct plan *plan, bool quiet, struct err *err);

/* Whether that would move anything. */
bool plan_has_to_move(const struct plan *plan);

/* Removes work/. A link is removed itself, never what it points to. Returns false, err set, when a stage is running there. */
bool plan_clean(const char *capture, struct err *err);

/* Looks into many captures, folders of call->capture, whose names stand on stdin with a zero byte behind each. Prints a line for each: the
 * exit status that --request has for it, a tab, and what that prints, tabs between; or, where it fails, what it says last. conf: items of
 * the command line. Returns the exit status: 0, or 1 with an error where the system lets no process be started. */
int plan_many(const struct call *call, const struct opt opts[PLAN_OPTS], const struct plan_cost cost[PLAN_STAGES], struct conf *conf,
              struct err *err);

/* Does what is asked and prints what is wrong. opts: cost's rows; conf: items of the command line. Returns the exit status: 0; 1, 2 with
 * an error in data, in the call; 3 where --todo, --request or --fresh finds something to do. */
int plan_run(const struct call *call, const struct plan_asked *asked, const struct opt opts[PLAN_OPTS],
             const struct plan_cost cost[PLAN_STAGES], struct conf *conf, struct err *err);

#endif
