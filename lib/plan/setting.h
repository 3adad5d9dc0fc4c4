/* setting: in place of a preset, the settings that `error = ...` or `time = ...` in capture.conf asks for, from the measured fronts
 * (base/front.h).
 */
#ifndef PLAN_SETTING_H
#define PLAN_SETTING_H
#include "base/front.h"
#include "plan/decide.h"

struct plan_choice {
	struct front front;
	struct front_ask ask;
	int chosen[PLAN_STAGES];  // for each stage a point of front; -1: its preset stands
	char *line;               // for the log: which points, how exact, how long; null: nothing is asked for
};

/* Says how large the iris maps will be and how long the stages then take; where capture.conf asks for an error or a time, chooses a
 * point of the fronts for each stage that runs, and puts it into the plan: seconds, setting, asked. A finer map costs the stages behind
 * unrefract more, too: for a time each of unrefract's points is tried, and the one that leaves the least sum of the errors' logarithms taken.
 * choice      out; plan_choice_free in any case
 * cost        one for each stage, in the order of plan_stages
 * config_dir  folder that holds fronts.conf; null: the one beside the programs
 * Returns false, err set, when capture.conf, fronts.conf or unrefract.conf cannot be read, or when no stage that runs is measured in the unit
 * that is asked for. */
bool plan_setting(struct plan_choice *choice, struct plan *plan, const struct plan_cost cost[PLAN_STAGES], const char *config_dir, const struct conf *conf, struct err *err);
void plan_choice_free(struct plan_choice *choice);

#endif
