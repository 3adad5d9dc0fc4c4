/* plan: which stages the folder needs, which it does not and why.
 * reads   names in photos/, views/, video/, targets/, script/; capture.conf
 * writes  work/plan.json, work/plan.mk
 */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plan.h"

#define ABOUT "which stages a capture folder needs, and why the others are not needed\n\n" \
	"  --show             print the plan as a table: what would run, why, how long\n" \
	"  --todo             exit 0 when every stage's last run still holds, 3 when one has to run\n" \
	"  --request          a line for each stage that has to run, STAGE SECONDS MIB, tabs between; exit 3 when there is one\n" \
	"  --requests         the same of many: folders of DIR, named on standard input, a zero byte behind each; a line each, STATUS and its lines\n" \
	"  --fresh=STAGE      exit 0 when that stage's last run still holds, 3 when it has to run\n" \
	"  --clean            remove the folder's work/ and nothing else"

static struct plan_asked take_asked(int *argc, char **argv)
{
	struct plan_asked asked = { 0 };
	int n = 1;
	for (int i = 1; i < *argc; i++)
		if (!strcmp(argv[i], "--show"))
			asked.show = true;
		else if (!strcmp(argv[i], "--todo"))
			asked.todo = true;
		else if (!strcmp(argv[i], "--request"))
			asked.request = true;
		else if (!strcmp(argv[i], "--requests"))
			asked.requests = true;
		else if (!strcmp(argv[i], "--clean"))
			asked.clean = true;
		else if (!strncmp(argv[i], "--fresh=", 8))
			asked.fresh = argv[i] + 8;
		else
			argv[n++] = argv[i];
	argv[*argc = n] = 0;
	return asked;
}

/* Two rows a stage: STAGE_seconds and STAGE_mib, as struct plan_cost has them. */
static void fill_table(struct opt opts[PLAN_OPTS], struct plan_cost cost[PLAN_STAGES])
{
	for (int i = 0; i < PLAN_STAGES; i++) {
		char *s = mem_printf("%s_seconds", plan_stages[i].name), *mib = mem_printf("%s_mib", plan_stages[i].name);
		opts[2 * i] = (struct opt)OPT_REALS(s, cost[i].seconds, PLAN_SECONDS, 0, 1e6, "s; s/Mpx; s/Mtexel; s/1000 frames; s/character; s/1000 frames of its clips", "estimated time of the stage");
		opts[2 * i + 1] = (struct opt)OPT_REALS(mib, cost[i].mib, 2, 0, 1e7, "MiB; MiB/Mpx", "estimated peak of its memory");
	}
}

int main(int argc, char **argv)
{
	struct call call;
	struct conf conf = { 0 };
	struct err err = { 0 };
	struct plan_cost cost[PLAN_STAGES];
	struct opt opts[PLAN_OPTS];
	struct plan_asked asked = take_asked(&argc, argv);
	fill_table(opts, cost);
	call_parse(&call, "plan", ABOUT, argc, argv, PLAN_OPTS, opts, &conf);
	int status = asked.requests ? plan_many(&call, opts, cost, &conf, &err) : plan_run(&call, &asked, opts, cost, &conf, &err);
	conf_free(&conf);
	for (int i = 0; i < PLAN_OPTS; i++)
		free((char *)opts[i].key);
	return status;
}
