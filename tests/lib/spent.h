/* spent: wall-clock and processor time of a program that is run. */
#ifndef TESTS_SPENT_H
#define TESTS_SPENT_H
#include "base/err.h"

struct spent {
	double wall, cpu;  // s; cpu: of all its threads and children; wall negative: it failed
};

/* Runs argv[0], looked for in PATH, to its end; what it says is appended to the file `log`. argv: null-terminated. */
bool spent_run(struct spent *spent, const char *const argv[], const char *log, struct err *err);

#endif
