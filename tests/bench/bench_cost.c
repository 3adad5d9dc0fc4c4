/* What each stage costs on the bundled captures, calibrate on eight photographs of the data, at draft: time on one processor and
 * on all of them, peak memory, and how much it reads, its program's own libraries not counted. Each is run as make runs it, in
 * turn, behind all that comes before it. --quick: the photograph at draft alone.
 */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/run.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"

enum { MOST_REPS = 3 };

struct column {
	const char *name, *make, *stages[8];  // make: shell text, fills the folder $C
	const char *qualities[2];
	bool slow;  // once each; left out of a quick run
	bool anew;  // what a stage keeps of an earlier run, even a forced one, is taken away before each
	const char *data, *program;  // what it needs: of bench_data, handed to `make` as $V; in PATH. Or null
};

static const struct column columns[] = {
	{ "photograph", "mkdir -p \"$C/photos\" && cp samples/demo/photos/right_softbox.jpg \"$C/photos\" && cat samples/demo/capture.conf",
	  { "limbus", "unrefract", "freckles", "heightfield", "pigment", "relief", "refraction", "render" }, { "draft", "review" }, .slow = false },
	{ "video", "mkdir -p \"$C\" && cp -r samples/face/video samples/face/targets samples/face/script samples/face/subject.ply \"$C\" && cat samples/face/capture.conf",
	  { "track", "train", "transfer", "extrapolate", "animate", "render" }, { "draft" }, .slow = true },
	{ "views", "mkdir -p \"$C/views\" && for v in 13 16 22 31 34 36 62 63; do cp \"$V/images/000$v.jpg\" \"$C/views\" || exit 1; done",
	  { "calibrate" }, { "draft" }, .slow = true, .anew = true, .data = "views/buddha", .program = "colmap" },
};

struct cost {
	double seconds, memory_mib, read_mib;
};

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What this process and all children it has waited for have read. */
static double read_mib(void)
{
	FILE *f = fopen("/proc/self/io", "r");
	double bytes = NAN;
	if (f && fscanf(f, "rchar: %lf", &bytes) != 1)
		bytes = NAN;
	if (f)
		fclose(f);
	return bytes / 1048576;
}

static bool run(struct cost *cost, const char *const argv[], const char *log)
{
	double before = read_mib(), start = now_s();
	fflush(stdout);
	pid_t pid = fork();
	if (!pid) {
		int fd = open(log, O_WRONLY | O_CREAT | O_APPEND, 0666);
		dup2(fd, STDOUT_FILENO);
		dup2(fd, STDERR_FILENO);
		execvp(argv[0], (char *const *)argv);
		_exit(127);
	}
	int status = 1;
	struct rusage use = { 0 };
	if (pid < 0 || wait4(pid, &status, 0, &use) != pid)
		return false;
	*cost = (struct cost){ now_s() - start, (double)use.ru_maxrss / 1024, read_mib() - before };
	return WIFEXITED(status) && !WEXITSTATUS(status);
}

static bool forget(const char *dir, const char *log)
{
	struct cost none;
	char *work = mem_printf("%s/work", dir);
	const char *const argv[] = { "rm", "-rf", work, 0 };
	bool ok = run(&none, argv, log);
	free(work);
	return ok;
}

/* One processor and all, in turn. */
static void stage(const char *name, const char *quality, const char *dir, const char *log, int reps, bool anew)
{
	char *program = mem_printf("bin/%s", name), *capture = mem_printf("--capture=%s", dir);
	double seconds[2][MOST_REPS];
	struct cost cost[2] = { 0 };
	bool ok = true;
	for (int i = 0; i < 2 * reps && ok; i++) {
		const char *const argv[] = { program, capture, "--force", "--quiet", i % 2 ? 0 : "--threads=1", 0 };
		ok = (!anew || forget(dir, log)) && run(&cost[i % 2], argv, log);
		seconds[i % 2][i / 2] = cost[i % 2].seconds;
	}
	for (int k = 0; k < 2 && ok; k++) {
		char *method = mem_printf("%s, %s", name, k ? "all processors" : "one processor");
		bench_row("what a stage costs", method, quality, bench_time_of(reps, seconds[k]), "run", k ? cost[k].memory_mib : cost[k].read_mib, "MiB",
		          k ? "peak memory" : "read");
		free(method);
	}
	if (!ok)
		fprintf(stderr, "%s failed; see %s\n", name, log);
	free(program);
	free(capture);
}

/* Whether all that the column needs is here; said, if not. */
static bool can_run(const struct column *c)
{
	const char *data = c->data ? bench_data(c->data) : 0;
	if (data)
		setenv("V", data, 1);
	if (c->data && !data)
		printf("%s: no %s among the data: left out\n", c->name, c->data);
	else if (c->program && !run_exists(c->program))
		printf("%s: %s is not installed: left out\n", c->name, c->program);
	else
		return true;
	return false;
}

static void column(const struct column *c, const char *quality)
{
	char *dir = mem_printf("%s", scratch_path("%s-%s", c->name, quality)), *log = mem_printf("%s.log", dir);
	struct cost all;
	setenv("C", dir, 1);
	setenv("Q", quality, 1);
	char *fill = mem_printf("{ %s; echo \"quality = $Q\"; } >\"$C.conf\" && mv \"$C.conf\" \"$C/capture.conf\"", c->make);
	const char *const filled[] = { "sh", "-c", fill, 0 };
	char *capture = mem_printf("CAPTURE=%s", dir);
	const char *const make[] = { "make", "--no-print-directory", capture, 0 };
	if (run(&all, filled, log) && run(&all, make, log)) {
		bench_row("what a make costs", c->name, quality, (struct bench_time){ all.seconds, all.seconds, all.seconds }, "make", all.memory_mib, "MiB",
		          "peak memory, the largest of its programs");
		for (int i = 0; i < COUNT(c->stages) && c->stages[i]; i++)
			stage(c->stages[i], quality, dir, log, c->slow || bench_quick() ? 1 : MOST_REPS, c->anew);
	} else
		fprintf(stderr, "%s: cannot be made; see %s\n", dir, log);
	free(fill);
	free(capture);
	free(dir);
	free(log);
}

int main(int argc, char **argv)
{
	bench_open("cost", argc, argv);
	scratch_open();
	// As make has them.
	setenv("OPENBLAS_NUM_THREADS", "1", 0);
	setenv("OMP_WAIT_POLICY", "passive", 0);
	setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
	for (int i = 0; i < COUNT(columns); i++)
		for (int q = 0; q < COUNT(columns[i].qualities) && columns[i].qualities[q]; q++)
			if ((!bench_quick() || !(columns[i].slow || q)) && can_run(&columns[i]))
				column(&columns[i], columns[i].qualities[q]);
	scratch_close();
	return bench_close();
}
