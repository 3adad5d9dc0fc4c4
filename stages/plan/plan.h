/* plan: which stages a capture folder needs, in what order, why the others are not needed, and about how long
 * each takes. Looks at names and file heads, and into a character's mesh only where it has as many vertices as the
 * subject's: it is started by every make. */
#ifndef STAGES_PLAN_PLAN_H
#define STAGES_PLAN_PLAN_H
#include <stdbool.h>

#include "base/call.h"
#include "base/conf.h"
#include "base/err.h"

enum { PLAN_STAGES = 15 };

/* Seconds of a stage on two processors: fixed, and for each megapixel of its input. */
struct plan_cost {
	double fixed_mpx[2];
};

struct plan_row {
	const char *name;
	bool run;
	const char *reason;  // fixed texts: they go into plan.mk
	double seconds;      // estimate; 0 when it does not run
	char *setting;       // chosen from the measured fronts; null: the preset. Owned by the plan
};

struct plan {
	const char *capture;
	struct plan_row rows[PLAN_STAGES];
	int n_run;           // plan itself not counted
	int n_photos;
	double mpx;          // of all photographs, as far as their heads tell
	char asked[64];      // "error = 0.05 mm", or ""
	char listing[33];    // hash of the names that decide
};

/* What is asked for beside planning: not part of the configuration, so not in the option table. */
struct plan_asked {
	bool show, clean, todo;
	const char *fresh;
};

/* Names of all stages in the order in which they run; the first is plan itself. */
extern const char *const plan_names[PLAN_STAGES];

/* cost: one for each stage, in the order of plan_names. False, err set, when the folder holds nothing to work on. */
bool plan_decide(struct plan *plan, const char *capture, const struct plan_cost cost[PLAN_STAGES], const struct conf *conf,
                 struct err *err);

/* Meshes in targets/, and how many of them have the faces of the subject's own mesh: nothing is registered for these. */
void plan_characters(int *all, int *same, const char *capture);

/* Whether stage i cannot do without the result of stage j; both count in plan_names. */
bool plan_needs(int i, int j);

/* The setting of each stage where capture.conf asks for an error or a time: lib/base/front.h. */
bool plan_setting(struct plan *plan, const struct call *call, const struct conf *conf, struct err *err);

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

/* bin/STAGE beside this program; free(). */
char *plan_program(const char *stage);

#endif
