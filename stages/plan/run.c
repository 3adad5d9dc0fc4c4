#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "anatomy/keys.h"
#include "base/file.h"
#include "base/front_use.h"
#include "base/say.h"
#include "base/work.h"
#include "plan.h"
#include "plan/setting.h"
#include "plan/skin.h"
#include "stages/plan/mirror.h"

static char *slice_of(const struct opt opts[PLAN_OPTS], const struct conf *conf)
{
	char *text = 0;
	size_t size = 0;
	FILE *f = open_memstream(&text, &size);
	opt_print(f, "plan", PLAN_OPTS, opts, conf);
	fclose(f);
	return text;
}

/* Brings work/ to where the plan finds it: also removes half-written files, since where no stage has to run none would do it. A running stage
 * does it itself, and is waited for where something has to be moved that the stages to come would read. */
static bool tidy(const struct plan *plan, const struct plan_asked *asked, bool quiet, struct err *err)
{
	struct err unwritable = { 0 };
	bool busy = false, ok = true;
	int lock = work_lock(plan->capture, &busy, &unwritable);
	if (lock < 0)
		return true;
	if (busy && !asked->show && !asked->request && plan_has_to_move(plan)) {
		work_wait(lock);
		busy = false;
	}
	if (!busy) {
		work_sweep(plan->capture);
		ok = plan_move(plan, quiet, err);
	}
	close(lock);
	return ok;
}

/* True when every stage's last run still holds; then prints what make prints at its end. */
static bool nothing_to_do(const struct plan *plan, const struct call *call)
{
	bool fresh = plan_all_fresh(plan, call);
	if (fresh && plan->rows[PLAN_STAGES - 1].run)
		printf("review page: %s/work/review/index.html\n", plan->capture);
	return fresh;
}

/* Chooses the settings that capture.conf asks for, writes them for the stages, and logs a choice that is new. */
static bool settle(struct plan *plan, const struct plan_cost cost[PLAN_STAGES], const struct call *call, const struct conf *conf, struct err *err)
{
	struct plan_choice choice;
	bool changed, ok = plan_setting(&choice, plan, cost, call->config_dir, conf, err);
	if (ok && choice.line && front_save(&choice.front, &choice.ask, PLAN_STAGES, choice.chosen, plan->capture, &changed, err)
	    && changed && !call->quiet)
		say_error("plan", choice.line);
	plan_choice_free(&choice);
	return !err_is(err);
}

static bool make_plan(const struct call *call, const struct plan_asked *asked, const struct opt opts[PLAN_OPTS],
                      const struct plan_cost cost[PLAN_STAGES], const struct conf *conf, bool *fresh, struct err *err)
{
	struct plan plan = { 0 };
	char *slice = slice_of(opts, conf);
	bool ok = work_check(call->capture, err) && plan_decide(&plan, call->capture, cost, conf, err)
	          && work_enter(call->capture, err) && settle(&plan, cost, call, conf, err) && plan_skins(&plan, call->config_dir, conf, err) && keys_check_names(conf, call->capture, err)
	          && plan_check_conf(&plan, conf, err)
	          && plan_write(&plan, slice, err);
	free(slice);
	ok = ok && tidy(&plan, asked, call->quiet, err);
	if (ok && asked->show)
		plan_show(&plan, call);
	if (ok && asked->todo)
		*fresh = nothing_to_do(&plan, call);
	if (ok && asked->request)
		*fresh = plan_request(&plan, call);
	for (int i = 0; i < PLAN_STAGES; i++)
		free(plan.rows[i].setting);
	plan_skins_free(&plan);
	if (ok && !plan.n_run)
		return err_set(err, "%s: nothing to run: %s", call->capture, plan.rows[plan_stage_find("limbus")].reason);
	return ok;
}

int plan_run(const struct call *call, const struct plan_asked *asked, const struct opt opts[PLAN_OPTS],
             const struct plan_cost cost[PLAN_STAGES], struct conf *conf, struct err *err)
{
	bool fresh = true;
	char *why = 0;
	if (!asked->clean && !asked->fresh && file_source() && !plan_mirror(call->capture, file_source(), err))
		;
	else if (asked->clean)
		plan_clean(call->capture, err);
	else if (asked->fresh)
		plan_fresh(&fresh, &why, call, asked->fresh, err);
	else if (call_load(call, "plan", conf, err) && opt_resolve("plan", PLAN_OPTS, opts, conf, err)) {
		if (call->print_config)
			opt_print(stdout, "plan", PLAN_OPTS, opts, conf);
		else
			make_plan(call, asked, opts, cost, conf, &fresh, err);
	}
	free(why);
	if (!err_is(err))
		return fresh ? 0 : 3;
	say_error("plan", err->msg);
	return err->usage ? 2 : 1;
}
