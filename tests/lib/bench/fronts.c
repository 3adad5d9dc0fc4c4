#include "tests/lib/bench/fronts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/conf.h"
#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"

static char *lines;  // of all stages measured so far

struct point {
	char name[40], values[200];
	bool preset;
	double error;
	struct bench_time time, small;
};

struct job {
	const struct fronts_stage *stage;
	const char *values, *capture;
	bool ok;
};

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool run(char *const argv[], const char *log)
{
	fflush(stdout);
	pid_t pid = fork();
	if (!pid) {
		if (!freopen(log, "a", stderr) || !freopen("/dev/null", "a", stdout))
			_exit(1);
		execvp(argv[0], argv);
		_exit(127);
	}
	int status = 1;
	waitpid(pid, &status, 0);
	return WIFEXITED(status) && !WEXITSTATUS(status);
}

/* The next of a list "a, b, c" as a string of its own, or null; *at moves on. free(). */
static char *next_of(const char **at)
{
	if (!*at || !**at)
		return 0;
	size_t n = strcspn(*at, ",");
	char *word = mem_printf("%.*s", (int)n, *at);
	*at += n + ((*at)[n] == ',');
	*at += strspn(*at, " ");
	return word;
}

static void remove_work(const char *capture)
{
	char *work = mem_printf("%s/work", capture);
	run((char *const[]){ "rm", "-rf", work, 0 }, "/dev/null");
	free(work);
}

static bool run_stage(const char *stage, const char *keys, const char *values, const char *always, const char *capture)
{
	char *argv[8 + FRONTS_KEYS + 4], *key, *value, *log = mem_printf("%s.log", capture);
	int n = 0;
	argv[n++] = mem_printf("bin/%s", stage);
	argv[n++] = mem_str("--force");
	argv[n++] = mem_str("--quiet");
	argv[n++] = mem_printf("--capture=%s", capture);
	while (n < 4 + FRONTS_KEYS && (key = next_of(&keys))) {
		value = next_of(&values);
		argv[n++] = mem_printf("--%s=%s", key, value ? value : "");
		free(key);
		free(value);
	}
	while (n < COUNT(argv) - 1 && (key = next_of(&always)))
		argv[n++] = key;
	argv[n] = 0;
	bool ok = run(argv, log);
	if (!ok)
		fprintf(stderr, "%s: failed; see %s\n", argv[0], log);
	while (n)
		free(argv[--n]);
	free(log);
	return ok;
}

static void timed(void *ctx)
{
	struct job *job = ctx;
	job->ok = run_stage(job->stage->stage, job->stage->keys, job->values, job->stage->always, job->capture);
}

/* What the keys are in a preset. */
static void preset_values(char out[200], const struct fronts_stage *s, const char *preset)
{
	struct conf conf = { 0 };
	struct err err = { 0 };
	char *file = mem_printf("config/%s.conf", s->stage), *key;
	const char *keys = s->keys;
	size_t n = 0;
	*out = 0;
	if (conf_load(&conf, file, "", 0, &err))
		while ((key = next_of(&keys))) {
			const struct conf_item *item = conf_find(&conf, key, preset);
			n += (size_t)snprintf(out + n, 200 - n, "%s%s", n ? ", " : "", item ? item->value : "");
			free(key);
		}
	conf_free(&conf);
	free(file);
}

static int points_of(struct point points[3 + FRONTS_SETTINGS], const struct fronts_stage *s)
{
	static const char *const presets[] = { "draft", "review", "final" };
	int n = 0;
	for (int i = 0; i < (s->draft_to_review ? 2 : 3); i++) {
		struct point p = { .preset = true };
		bool again = false;
		preset_values(p.values, s, presets[i]);
		snprintf(p.name, sizeof p.name, "%s", presets[i]);
		for (int k = 0; k < n; k++)
			if (!strcmp(points[k].values, p.values)) {  // two presets may be the same point
				again = true;
				strncat(points[k].name, "_", sizeof points[k].name - strlen(points[k].name) - 1);
				strncat(points[k].name, presets[i], sizeof points[k].name - strlen(points[k].name) - 1);
			}
		if (!again)
			points[n++] = p;
	}
	for (int i = 0; i < FRONTS_SETTINGS && s->more[i].name; i++) {
		struct point *p = &points[n++];
		*p = (struct point){ 0 };
		snprintf(p->name, sizeof p->name, "%s", s->more[i].name);
		snprintf(p->values, sizeof p->values, "%s", s->more[i].values);
	}
	return n;
}

static void time_all(int n, struct point points[], const struct fronts_stage *s, const char *capture, bool small)
{
	struct job jobs[3 + FRONTS_SETTINGS];
	void (*fn[3 + FRONTS_SETTINGS])(void *) = { 0 };
	void *ctx[3 + FRONTS_SETTINGS] = { 0 };
	struct bench_time times[3 + FRONTS_SETTINGS];
	for (int i = 0; i < n; i++) {
		jobs[i] = (struct job){ s, points[i].values, capture, true };
		fn[i] = timed;
		ctx[i] = &jobs[i];
	}
	bench_times(n, times, fn, ctx, s->reps);
	for (int i = 0; i < n; i++)
		*(small ? &points[i].small : &points[i].time) = jobs[i].ok ? times[i] : (struct bench_time){ NAN, NAN, NAN };
}

/* What a time may be of a run made once: a tenth more or less. */
static struct bench_time with_spread(struct bench_time t)
{
	return t.low < t.high ? t : (struct bench_time){ t.median, 0.9 * t.median, 1.1 * t.median };
}

/* Beaten, beyond the spread: another is as exact and faster by a tenth, or no slower and more exact by a tenth. */
static bool beats(const struct point *a, const struct point *b)
{
	struct bench_time ta = with_spread(a->time), tb = with_spread(b->time);
	bool faster = ta.high < tb.low && ta.median < 0.9 * tb.median, no_slower = ta.high <= tb.median;
	bool exacter = a->error < 0.9 * b->error;
	return (faster && a->error <= b->error) || (exacter && no_slower);
}

/* One line of config/fronts.conf, and further ones where the keys do not fit it. */
static void add_line(const struct fronts_stage *s, const struct point *p, const double mpx[2], bool two)
{
	enum { LINE = 190 };  // of the 198 bytes that a configuration's line may have
	enum { LOAD_MS = 10 };  // of the time that goes with texels: the program itself
	const double texels = s->mtexel > 0 ? fmax(p->time.median - 1e-3 * LOAD_MS, 0) / s->mtexel : 0;
	double slope = two ? fmax((p->time.median - p->small.median) / (mpx[0] - mpx[1]), 0) : 0, fixed = fmax(p->time.median - slope * mpx[0], 0);
	const char *keys = s->keys, *values = p->values;
	char *text = 0, *key;
	size_t size = 0;
	FILE *f = open_memstream(&text, &size);
	int at = s->mtexel > 0 ? fprintf(f, "%s.%s = %.3g %s, %.3g s + 0 s/Mpx + %.3g s/Mtexel: ", s->stage, p->name, p->error, s->unit, 1e-3 * LOAD_MS, texels)
	                       : fprintf(f, "%s.%s = %.3g %s, %.3g s + %.3g s/Mpx: ", s->stage, p->name, p->error, s->unit, fixed, slope);
	for (int i = 0, more = 0; (key = next_of(&keys)); i++) {
		char *value = next_of(&values);
		if (at + (int)strlen(key) + (int)strlen(value ? value : "") + 5 > LINE) {
			at = fprintf(f, "\n%s.%s.more%.0d = ", s->stage, p->name, more) - 1;  // .more, .more2, .more3
			more += more ? 1 : 2;
		} else if (i) {
			at += fprintf(f, ", ");
		}
		at += fprintf(f, "%s = %s", key, value ? value : "");
		free(key);
		free(value);
	}
	fclose(f);
	char *all = mem_printf("%s%s\n", lines ? lines : "", text);
	free(lines);
	free(text);
	lines = all;
}

static void judge(int n, const struct point points[], const struct fronts_stage *s, const double mpx[2], bool two)
{
	int beaten = 0;
	for (int i = 0; i < n; i++) {
		bool front = isfinite(points[i].error) && isfinite(points[i].time.median);
		for (int k = 0; k < n; k++) {
			if (k == i || !beats(&points[k], &points[i]))
				continue;
			front = false;
			if (points[i].preset && ++beaten)
				printf("  %s: preset %s (%s) is beaten by %s (%s)\n", s->stage, points[i].name, points[i].values, points[k].name, points[k].values);
		}
		char *setting = mem_printf("%s: %s%s", points[i].name, points[i].values, front ? "" : " (beaten)"), *table = mem_printf("front of %s", s->stage);
		bench_row(table, points[i].preset ? "presets" : "other settings", setting, points[i].time, "run", points[i].error, s->unit, s->error_of);
		if (front)
			add_line(s, &points[i], mpx, two);
		free(setting);
		free(table);
	}
	char *measure = mem_printf("%s: presets that another setting beats in time and error", s->stage);
	bench_goal(measure, "none", beaten, "", beaten == 0);
	free(measure);
}

bool fronts_left_out(void)
{
	if (bench_quick())
		printf("--quick: fronts take minutes and are left out; config/fronts.conf has those measured last\n");
	return bench_quick();
}

void fronts_measure(const struct fronts_stage *s, const char *capture, const char *small, const double mpx[2])
{
	struct point points[3 + FRONTS_SETTINGS];
	const char *alone = getenv("STAGES");
	if (alone && !strstr(alone, s->stage))
		return;
	char *reference = mem_printf("%s.reference", capture);
	int n = points_of(points, s);
	if (s->finest.values) {
		bool ok = run_stage(s->stage, s->keys, s->finest.values, s->always, capture);
		ok = ok && (!s->after || run_stage(s->after, 0, 0, 0, capture)) && fronts_keep(capture, reference);
		if (!ok)
			return;
	}
	for (int i = 0; i < n; i++) {
		if (s->anew)
			remove_work(capture);
		double begin = now_s();
		bool ok = run_stage(s->stage, s->keys, points[i].values, s->always, capture);
		double took = ok ? now_s() - begin : NAN;
		points[i].time = (struct bench_time){ took, took, took };
		ok = ok && (!s->after || run_stage(s->after, 0, 0, 0, capture));
		points[i].error = ok ? s->error(capture, reference) : NAN;
		if (s->also)
			points[i].error = (points[i].error + (run_stage(s->stage, s->keys, points[i].values, s->always, s->also) ? s->error(s->also, reference) : NAN)) / 2;
	}
	if (s->reps)
		time_all(n, points, s, capture, false);
	if (small)
		time_all(n, points, s, small, true);
	judge(n, points, s, mpx, small);
	free(reference);
	if (s->anew)
		return;
	char *const restore[] = { mem_printf("bin/%s", s->stage), mem_str("--force"), mem_str("--quiet"), mem_printf("--capture=%s", capture), 0 };
	run(restore, "/dev/null");
	for (int i = 0; restore[i]; i++)
		free(restore[i]);
}

bool fronts_keep(const char *capture, const char *reference)
{
	char *command = mem_printf("rm -rf '%s' && cp -r '%s/work' '%s'", reference, capture, reference);
	bool ok = !system(command);
	free(command);
	return ok;
}

bool fronts_make(const char *capture, const char *stage)
{
	char *log = mem_printf("%s.log", capture), *arg = mem_printf("CAPTURE=%s", capture);
	bool ok = run((char *const[]){ "make", "--no-print-directory", arg, (char *)stage, 0 }, log);
	if (!ok)
		fprintf(stderr, "make %s %s: failed; see %s\n", arg, stage, log);
	free(log);
	free(arg);
	return ok;
}

bool fronts_write(const char *dir, const char *name, struct err *err)
{
	char *path = mem_printf("%s/%s.front", dir, name);
	bool ok = !lines || file_write(path, lines, strlen(lines), err);
	free(path);
	free(lines);
	lines = 0;
	return ok;
}
