#include <stdlib.h>

#include "base/aside.h"
#include "base/mem.h"
#include "base/record_holds.h"
#include "base/record_leave.h"
#include "base/say.h"
#include "plan.h"

static bool is_away(const char *capture, const char *stage)
{
	return !aside_stands(capture, stage, false) && aside_stands(capture, stage, true);
}

/* Whether a stage that the folder does not need has left something there that is not the folder's: what it read is gone, or what it has to
 * follow is put aside. A folder that never had the inputs, but holds all that was read (somebody else's rig, say), keeps what was made of that. */
static bool leaves(const struct plan *plan, int i)
{
	const struct plan_row *row = &plan->rows[i];
	const char *needs = plan_stages[i].needs;
	return !row->run && aside_stands(plan->capture, row->name, false)
	       && (row->told || (needs && is_away(plan->capture, needs)) || !record_inputs_hold(plan->capture, row->name));
}

bool plan_has_to_move(const struct plan *plan)
{
	bool has = false;
	for (int i = 1; i < PLAN_STAGES && !has && !plan->unbuilt; i++)
		has = plan->rows[i].run ? is_away(plan->capture, plan->rows[i].name) : leaves(plan, i);
	return has;
}

bool plan_move(const struct plan *plan, bool quiet, struct err *err)
{
	char *names = mem_str("");
	bool ok = true;
	// In their order: what one has left the next has lost. Where programs are missing, it is they and not the folder that decide.
	for (int i = 1; i < PLAN_STAGES && ok && !plan->unbuilt; i++) {
		const char *name = plan->rows[i].name;
		if (plan->rows[i].run)
			ok = record_return(plan->capture, name, err);
		else if (leaves(plan, i) && (ok = record_leave(plan->capture, name, err))) {
			char *more = mem_printf("%s%s%s", names, *names ? ", " : "", name);
			free(names);
			names = more;
		}
	}
	if (*names && !quiet) {
		char *line = mem_printf("not of this capture any more: what %s made is put aside in work/.made/aside, and is back once its inputs are", names);
		say_error("plan", line);
		free(line);
	}
	free(names);
	return ok;
}
