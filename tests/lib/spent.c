#include "tests/lib/spent.h"

#include <sys/resource.h>
#include <time.h>

#include "base/run.h"

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double children_s(void)
{
	struct rusage use;
	getrusage(RUSAGE_CHILDREN, &use);
	return (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) + 1e-6 * (double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

bool spent_run(struct spent *spent, const char *const argv[], const char *log, struct err *err)
{
	double start = now_s(), cpu = children_s();
	bool ok = run_program(&(struct run){ .argv = argv, .log = log }, err);
	*spent = (struct spent){ ok ? now_s() - start : -1, children_s() - cpu };
	return ok;
}
