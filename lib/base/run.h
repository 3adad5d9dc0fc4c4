/* run: other programs, run as they are: no shell, what they say in a log and line by line to the caller. */
#ifndef BASE_RUN_H
#define BASE_RUN_H
#include "base/err.h"

struct run {
	const char *const *argv;         // null-terminated; argv[0] is looked for in PATH
	const char *const *env;          // further "NAME=value", null-terminated; or null
	const char *log;                 // file its output is appended to
	void (*line)(void *ctx, const char *line);  // every line of its output, control bytes left out; or null
	void *ctx;
	const char *install;             // what to say when it is not installed: "apt-get install colmap"
	const char *dir;                 // the folder it runs in; null: ours
};

/* Runs it to its end. False, err set in one line, when it is not installed, cannot be started, was killed (by which
 * signal), or failed: the error names the folder's disk if it is full, else the last thing it said that looks like a
 * reason. The child's own files are wherever it was told to put them; its current folder is ours unless `dir` says another. */
bool run_program(const struct run *run, struct err *err);

/* As run_program, n of them, at most `threads` at a time. The first error is reported when all have ended. */
bool run_programs(int n, const struct run runs[], int threads, struct err *err);

/* True when a program of this name stands in PATH. */
bool run_exists(const char *name);

#endif
