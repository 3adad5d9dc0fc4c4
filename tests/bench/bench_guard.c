/* What it costs that the kernel keeps a stage from what it does not need: the guard itself, a photograph decoded behind it, a program
 * started behind it, as COLMAP is, and a reader in a process of its own, as Assimp is. Each in a child: there is no way back. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/apart.h"
#include "base/file.h"
#include "base/guard.h"
#include "base/mem.h"
#include "base/run.h"
#include "image/photo/photo.h"
#include "tests/lib/bench/bench.h"

#define PHOTO "samples/demo/photos/right_softbox.jpg"
enum { MOST = 200 };
static char work[] = "/tmp/bench-guard-XXXXXX";
static char *log_path;

/* Processor time of this process, s. */
static double spent(void)
{
	struct timespec own;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
	return (double)own.tv_sec + 1e-9 * (double)own.tv_nsec;
}

static double by_the_clock(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void nothing(void) {}
static void guard(void) { guard_enter(work, ".", false); }
static void guard_programs(void) { guard_enter(work, ".", true); }

static void decode(void)
{
	struct photo photo;
	struct err err = { 0 };
	if (!photo_load(&photo, PHOTO, 200, &err))
		_exit(1);
	photo_free(&photo);
}

static void start(void)
{
	static const char *const argv[] = { "true", 0 };
	const struct run run = { .argv = argv, .log = log_path };
	struct err err = { 0 };
	if (!run_program(&run, &err))
		_exit(1);
}

static bool put_little(void *ctx, struct apart_out *out, struct err *err)
{
	(void)ctx;
	(void)err;
	return apart_put(out, "x", 1);
}

static void read_apart(void)
{
	const struct apart apart = { .run = put_little, .reads = "samples", .memory = 1 << 28, .result = 1 << 20, .seconds = 5 };
	struct err err = { 0 };
	char *data;
	size_t size;
	if (!apart_run(&data, &size, &apart, &err))
		_exit(1);
	free(data);
}

/* Seconds of `what` in n children of their own, `before` once ahead of it in each. */
static struct bench_time in_children(void (*before)(void), void (*what)(void), double (*clock)(void), int n)
{
	double *seconds = mmap(0, MOST * sizeof *seconds, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0), kept[MOST];
	int got = 0;
	for (int i = 0; i < n && i < MOST; i++) {
		const pid_t child = fork();
		int status = 1;
		if (!child) {
			before();
			const double begin = clock();
			what();
			seconds[i] = clock() - begin;
			_exit(0);
		}
		if (child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && !WEXITSTATUS(status))
			kept[got++] = seconds[i];
	}
	munmap(seconds, MOST * sizeof *seconds);
	return got ? bench_time_of(got, kept) : (struct bench_time){ NAN, NAN, NAN };
}

static void pair(const char *table, const char *setting, void (*before)(void), void (*what)(void), double (*clock)(void), const char *per, int n)
{
	const struct bench_time free_time = in_children(nothing, what, clock, n), kept = in_children(before, what, clock, n);
	bench_row(table, "without the guard", setting, free_time, per, NAN, "", "");
	bench_row(table, "behind the guard", setting, kept, per, NAN, "", "");
	printf("%s, %s: %.3f ms without the guard, %.3f ms behind it\n", table, setting, 1e3 * free_time.median, 1e3 * kept.median);
}

int main(int argc, char **argv)
{
	bench_open("guard", argc, argv);
	if (!mkdtemp(work))
		return 1;
	log_path = mem_printf("%s/log", work);
	const int n = bench_quick() ? 20 : MOST;
	const struct bench_time alone = in_children(nothing, guard, spent, n), programs = in_children(nothing, guard_programs, spent, n),
	                        apart = in_children(nothing, read_apart, by_the_clock, n);
	bench_row("guard", "limits, Landlock, seccomp", "a stage, processor time", alone, "stage", NAN, "", "");
	bench_row("guard", "limits, Landlock, seccomp", "a stage that starts programs, processor time", programs, "stage", NAN, "", "");
	bench_row("guard", "a process of its own", "a reader that does nothing, wall time", apart, "file", NAN, "", "");
	printf("the guard: %.3f ms a stage, %.3f ms one that starts programs, of the processor; a reader apart: %.3f ms\n", 1e3 * alone.median,
	       1e3 * programs.median, 1e3 * apart.median);
	pair("behind the guard", "a photograph of 2 megapixels decoded, processor time", guard, decode, spent, "photograph", n / 4);
	pair("behind the guard", "a program started, wall time", guard_programs, start, by_the_clock, "program", n / 2);
	bench_goal("the guard round a stage", "at most 1 ms of the processor", 1e3 * alone.median, "ms", alone.median <= 1e-3);
	unlink(log_path);
	rmdir(work);
	free(log_path);
	return bench_close();
}
