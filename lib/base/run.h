/* run: other programs run as child processes, without a shell; their output goes to a log and line by line to the caller. */
#ifndef BASE_RUN_H
#define BASE_RUN_H
#include "base/err.h"

struct run {
	const char *const *argv;         // null-terminated; argv[0] is looked for in PATH
	const char *const *env;          // further "NAME=value", null-terminated; or null
	const char *log;                 // file its output is appended to
	void (*line)(void *ctx, const char *line);  // every line of its output, control bytes left out; or null
	void *ctx;
	const char *install;             // named in the error when it is not installed: "apt-get install colmap"
	const char *dir;                 // the folder it runs in; null: ours
};

/* Runs a program to its end. Returns false, err set, when it is not installed, cannot be started, was killed (by which signal), or
 * failed: the error names the disk if it is full, else the last line of output that looks like a reason. */
bool run_program(const struct run *run, struct err *err);

/* Runs n programs, at most `threads` at a time. When all have ended, returns false with the first error, if there was one. */
bool run_programs(int n, const struct run runs[], int threads, struct err *err);

/* Whether PATH has a program of this name. */
bool run_exists(const char *name);

#endif
