/* bench: one harness for all benchmark programs.
 * A program measures, calls bench_row() for each method and setting (speed and error of the same run) and
 * bench_goal() for each figure that has a bar. Output: bench/NAME.csv and NAME.goals.csv; `make bench` turns
 * all of them into tables and plots of error against time (tests/bench/report/report.c). NAME.yard: seconds of a loop that is the
 * same in every revision, taken in between: how fast the machine was (tests/bench/report/compare.c).
 */
#ifndef TESTS_BENCH_H
#define TESTS_BENCH_H
#include <stdbool.h>

/* name: of the program's tables. Reads --quick (fewer repetitions and cases) and --out=DIR (default bench). */
void bench_open(const char *name, int argc, char **argv);
bool bench_quick(void);

/* The folder of --out. */
const char *bench_out(void);

struct bench_time {
	double median, low, high;  // seconds a call; low and high: the quartiles
};

/* Calls fn(ctx) `reps` times after one warm-up; median and quartiles of wall-clock seconds. */
struct bench_time bench_time(void (*fn)(void *), void *ctx, int reps);

/* n alternatives interleaved A B C A B C ..., so that drift of the machine hits all alike. */
void bench_times(int n, struct bench_time out[], void (*const fn[])(void *), void *const ctx[], int reps);

/* Median and quartiles of n measured times; sorts them. */
struct bench_time bench_time_of(int n, double seconds[]);

/* The same for 1 / n of the work: time.median / n and so on. */
struct bench_time bench_time_each(struct bench_time time, double n);

/* table: which plot and table it belongs to. method: "algorithm 1 (paper)"; setting: "1000 steps"; per: what the
 * time is for ("solve", "photograph"); units of a solve: seconds are scaled to ns, ms or s when printed.
 * error and its unit, with what it is ("K, worst"). time may be NAN (not timed), error may be NAN. */
void bench_row(const char *table, const char *method, const char *setting, struct bench_time time, const char *per,
               double error, const char *error_unit, const char *error_of);

/* A goal of the project: what is measured, the bar in words, the figure, its unit, whether it is reached. Where measuring failed:
 * NAN and false. A goal whose wording was changed says in `reach` how it was worded first, and the goal in its first wording, where
 * that can still be measured, comes before it. */
void bench_goal(const char *measure, const char *reach, double got, const char *unit, bool reached);

/* Writes the files, then names the goals that were missed. Returns the exit status for main: 1 if any goal was missed or a file
 * could not be written, else 0. */
int bench_close(void);

/* A folder of shared ground-truth data: $EYEWRIGHT_DATA, or ../shared/data beside the checkout. Null: not there.
 * Valid until the eighth call after this one. */
const char *bench_data(const char *rel);

/* "213 ns", "1.4 ms": seconds in the unit that suits them, in a caller's buffer; "-" for NAN. */
const char *bench_seconds(char out[32], double seconds);

#endif
