#include "sfm/colmap/run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/run.h"
#include "sfm/options.h"

#define INSTALL "apt-get install colmap (or give the cameras in capture.conf and take views/ away)"

struct progress {
	struct stage *stage;
	const char *what;
	int total, done;
};

/* Reads the progress from a line of output: "Processed file [3/67]", "Registering image #12 (5)". */
static void take_line(void *ctx, const char *line)
{
	struct progress *p = ctx;
	int done, total, id;
	const char *bracket = strchr(line, '[');
	if (!strncmp(line, "Processed file ", 15) && bracket && sscanf(bracket, "[%d/%d]", &done, &total) == 2) {
		p->done = done;
		stage_progress(p->stage, done, total, p->what);
	} else if (sscanf(line, "Registering image #%d (%d)", &id, &done) == 2 && done > p->done) {
		p->done = done;
		stage_progress(p->stage, done, p->total > done ? p->total : done, p->what);
	}
}

// Ceres inside it would leave a log of every adjustment in the folder for temporary files.
static const char *const env[] = { "QT_QPA_PLATFORM=offscreen", "OPENBLAS_NUM_THREADS=1", "GLOG_minloglevel=2", 0 };

static const char **arguments(const char *task, const char *const args[])
{
	int n = 0;
	while (args[n])
		n++;
	const char **argv = mem_new((size_t)n + 3, sizeof *argv);
	argv[0] = "colmap";
	argv[1] = task;
	memcpy(argv + 2, args, (size_t)n * sizeof *argv);
	return argv;
}

static bool run_in(struct stage *stage, const char *dir, const char *task, const char *const args[], int total, const char *what,
                   struct err *err)
{
	struct progress p = { stage, what, total, 0 };
	const char **argv = arguments(task, args);
	const struct run run = { argv, env, stage_path(stage, CALIBRATE_DIR "/colmap.log"), take_line, &p, INSTALL, dir };
	bool ok = run_program(&run, err);
	free(argv);
	return ok;
}

bool colmap_run(struct stage *stage, const char *task, const char *const args[], int total, const char *what,
                struct err *err)
{
	return run_in(stage, 0, task, args, total, what, err);
}

bool colmap_run_inside(struct stage *stage, const char *task, const char *const args[], const char *what, struct err *err)
{
	return run_in(stage, stage_path(stage, CALIBRATE_DIR), task, args, 0, what, err);
}

bool colmap_run_parts(struct stage *stage, const char *task, int n, const char *const *const args[], const char *what,
                      struct err *err)
{
	struct progress p = { stage, what, n, 0 };
	struct run *runs = mem_new((size_t)n, sizeof *runs);
	const char ***argv = mem_new((size_t)n, sizeof *argv);
	for (int i = 0; i < n; i++) {
		argv[i] = arguments(task, args[i]);
		runs[i] = (struct run){ argv[i], env, stage_path(stage, CALIBRATE_DIR "/colmap.log"), take_line, &p, INSTALL, 0 };
	}
	bool ok = run_programs(n, runs, stage->threads, err);
	for (int i = 0; i < n; i++)
		free(argv[i]);
	free(argv);
	free(runs);
	return ok;
}
