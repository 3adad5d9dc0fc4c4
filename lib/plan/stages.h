/* stages: the table of all stages: name, what each needs, why it runs or does not. It is the only list of them: make, the
 * review page and plan's own configuration follow it.
 */
#ifndef PLAN_STAGES_H
#define PLAN_STAGES_H
#include <stdbool.h>

/* The last is render: it runs behind all others. */
enum { PLAN_STAGES = 15 };

/* What a capture folder holds, one bit each. */
enum { HAS_PHOTOS = 1, HAS_VIEWS = 2, HAS_VIDEO = 4, HAS_TARGETS = 8, HAS_SCRIPT = 16 };

/* A stage runs when the folder has one of `any` and all of `all`, and the stage that it needs runs; or when one of the other
 * ways is open: the folder has all of that `all`, and the stage needed there runs. */
struct plan_stage {
	const char *name;            // of its program, its folder and its configuration file
	const char *title;           // of its column of figures on the review page's part about skin; null: it has none
	const char *needs;           // the stage without whose result it cannot run; null: none
	bool takes_cameras;          // it takes cameras, or the person's mesh, from calibrate where that runs: it comes behind it
	int any, all;                // HAS_...
	const char *does, *without;  // the reasons: what it does, where it runs; what is missing, where the folder lacks something
	struct {
		const char *needs;
		int all;
	} other[3];                  // in the order in which they are tried; needs null: none
};

/* In the order in which they run; the first is plan itself. */
extern const struct plan_stage plan_stages[PLAN_STAGES];

/* Index of the stage of that name; -1: there is none. */
int plan_stage_find(const char *name);

/* Whether stage i has to wait for stage j where both run. */
bool plan_stage_needs(int i, int j);

/* Path of bin/STAGE beside this program. free(). */
char *plan_stage_program(const char *name);

#endif
