#include "base/stage.h"

#include <limits.h>
#include <omp.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/asked.h"
#include "base/blas.h"
#include "base/call.h"
#include "base/guard.h"
#include "base/mem.h"
#include "base/record_left.h"
#include "base/run.h"
#include "base/say.h"
#include "base/version.h"
#include "base/work.h"

/* Null in a program that starts no other: it is not linked with run.c then. */
#pragma weak run_programs

/* Guards the record and the log, which threads of a stage share. Recursive, since some functions here call others. */
static pthread_mutex_t busy = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;

void stage_calm(char **argv)
{
	if (!getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 0) == 0 && setenv("OPENBLAS_NUM_THREADS", "1", 0) == 0)
		execv("/proc/self/exe", argv);
}

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static const char *keep(struct stage *stage, char *s)
{
	pthread_mutex_lock(&busy);
	stage->strings = mem_grow(stage->strings, (size_t)stage->n_strings + 1, sizeof *stage->strings);
	stage->strings[stage->n_strings++] = s;
	pthread_mutex_unlock(&busy);
	return s;
}

_Noreturn static void die(const struct stage *stage, const struct err *err, int status)
{
	say_error(stage->name, err->msg);
	exit(status);
}

/* Locks the folder for one stage at a time: a second program waits for the first. */
static bool lock_work(struct stage *stage, struct err *err)
{
	bool busy = false;
	stage->lock = work_lock(stage->capture, &busy, err);
	if (stage->lock < 0)
		return false;
	if (busy) {
		stage_note(stage, "waiting for another program in %s", stage->capture);
		work_wait(stage->lock);
	}
	work_sweep(stage->capture);
	return true;
}

static char *slice(struct stage *stage)
{
	char *text = 0;
	size_t size = 0;
	FILE *f = open_memstream(&text, &size);
	opt_print(f, stage->name, stage->n_opts, stage->opts, &stage->conf);
	fclose(f);
	return text;
}

void stage_start(struct stage *stage, const char *name, const char *about, int argc, char **argv, int n_opts,
                 const struct opt opts[])
{
	*stage = (struct stage){ .name = name, .n_opts = n_opts, .opts = opts, .lock = -1, .start_s = now_s() };
	struct err err = { 0 };
	struct call call;
	call_parse(&call, name, about, argc, argv, n_opts, opts, &stage->conf);
	stage->capture = call.capture;
	stage->quiet = call.quiet;
	stage->force = call.force;
	stage->only = call.only;
	if (!call_load(&call, name, &stage->conf, &err) || !opt_resolve(name, n_opts, opts, &stage->conf, &err))
		die(stage, &err, err.usage ? 2 : 1);
	if (call.print_config) {
		opt_print(stdout, name, n_opts, opts, &stage->conf);
		exit(0);
	}
	// At most as many threads as there are cores: memory grows with them, results do not depend on them.
	int all = omp_get_num_procs();
	stage->threads = call.threads > 0 && call.threads < 4 * all ? call.threads : all;
	omp_set_num_threads(stage->threads);
	if (!blas_prepare(stage->threads, &err)) {
		say_error(name, err.msg);
		_exit(1);
	}
	asked_watch(stage->capture);
	struct file_list list;
	if (!file_list(&list, stage->capture, &err) || !file_exists(stage->capture)) {
		err_set(&err, "%s: no such folder", stage->capture);
		die(stage, &err, 1);
	}
	file_list_free(&list);
	if (!lock_work(stage, &err))
		die(stage, &err, 1);
	char *work = mem_printf("%s/work", stage->capture);
	guard_enter(work, stage->capture, run_programs);
	free(work);
	char *program = call_program_path(), *config = slice(stage);
	stage->record = record_open(stage->capture, name, program, config);
	for (int i = 0; i < n_opts; i++)
		if (opts[i].type == OPT_T_EACH) {
			char *pattern = opt_full_key(name, opts[i].key);
			record_each(stage->record, pattern);
			free(pattern);
		}
	free(program);
	free(config);
	say_log_open();
}

const char *stage_path(struct stage *stage, const char *fmt, ...)
{
	va_list ap;
	char *rel = 0;
	va_start(ap, fmt);
	if (vasprintf(&rel, fmt, ap) < 0)
		rel = mem_str("");
	va_end(ap);
	char *path = mem_printf("%s/%s", stage->capture, rel);
	free(rel);
	return keep(stage, path);
}

/* Removes the names that leave no room for what is made of them. Of photographs limbus, which comes first, says so. */
static void drop_long(struct stage *stage, struct file_list *list, const char *dir)
{
	enum { NAME_MOST = 200 };
	int n = 0;
	for (int i = 0; i < list->n; i++) {
		char *name = list->names[i];
		if (strlen(name) <= NAME_MOST) {
			list->names[n++] = name;
			continue;
		}
		const bool said = !strcmp(dir, "photos") && strcmp(stage->name, "limbus");
		(said ? stage_skipped_as_said : stage_skipped)(stage, "%s/%.30s…: left out: its name has %zu bytes, must have at most %d", dir, name,
		                                               strlen(name), NAME_MOST);
		free(name);
	}
	list->n = n;
}

bool stage_list(struct stage *stage, struct file_list *out, const char *dir, struct err *err)
{
	char hash[33];
	if (!file_list(out, stage_path(stage, "%s", dir), err))
		return false;
	record_listing_hash(hash, out->n, out->names);
	pthread_mutex_lock(&busy);
	record_list(stage->record, dir, hash);
	pthread_mutex_unlock(&busy);
	drop_long(stage, out, dir);
	return true;
}

bool stage_has(struct stage *stage, const char *rel)
{
	const bool has = file_exists(stage_path(stage, "%s", rel));  // which notes what is not there (asked.h)
	pthread_mutex_lock(&busy);
	if (has)
		record_there(stage->record, rel);
	pthread_mutex_unlock(&busy);
	return has;
}

bool stage_fresh(struct stage *stage, const char *out, int n, const char *const in[])
{
	pthread_mutex_lock(&busy);
	bool fresh = !stage->force && record_fresh(stage->record, out, n, in);
	if (fresh)
		say_log_artifact(out, false);
	pthread_mutex_unlock(&busy);
	return fresh;
}

const char *stage_made_by(struct stage *stage, int n, const char *const in[])
{
	json_t *made = json_object(), *inputs = json_object();
	pthread_mutex_lock(&busy);
	for (int i = 0; i < n; i++) {
		const char *hash = record_hash(stage->record, in[i]);
		if (json_object_set_new(inputs, in[i], json_string(hash ? hash : "")))
			json_object_set_new(inputs, "(name is not UTF-8)", json_string(hash ? hash : ""));
	}
	json_object_set_new(made, "stage", json_string(stage->name));
	json_object_set_new(made, "version", json_string(EYEWRIGHT_VERSION));
	json_object_set(made, "config", json_object_get(stage->record->now, "config"));
	json_object_set_new(made, "inputs", inputs);
	char *text = json_dumps(made, JSON_COMPACT | JSON_SORT_KEYS);
	json_decref(made);
	pthread_mutex_unlock(&busy);
	return keep(stage, text);
}

bool stage_made(struct stage *stage, const char *out, int n, const char *const in[], struct err *err)
{
	pthread_mutex_lock(&busy);
	record_made(stage->record, out, n, in);
	say_log_artifact(out, true);
	bool ok = record_save(stage->record, false, err);
	pthread_mutex_unlock(&busy);
	return ok;
}

bool stage_put_aside(struct stage *stage, const char *dir, struct err *err)
{
	pthread_mutex_lock(&busy);
	bool ok = record_put_aside(stage->record, dir, err);
	pthread_mutex_unlock(&busy);
	return ok;
}

static void end_line(struct stage *stage)
{
	if (stage->progress_open)
		fputc('\n', stderr);
	stage->progress_open = false;
}

static void say(struct stage *stage, const char *fmt, va_list ap)
{
	pthread_mutex_lock(&busy);
	end_line(stage);
	say_line(stage->name, fmt, ap);
	pthread_mutex_unlock(&busy);
}

void stage_note(struct stage *stage, const char *fmt, ...)
{
	if (stage->quiet)
		return;
	va_list ap;
	va_start(ap, fmt);
	say(stage, fmt, ap);
	va_end(ap);
}

void stage_warn(struct stage *stage, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	say(stage, fmt, ap);
	va_end(ap);
}

void stage_progress(struct stage *stage, int done, int total, const char *what)
{
	double now = now_s(), passed = now - stage->start_s;
	if (strncmp(stage->progress_what, what, sizeof stage->progress_what - 1) || done < stage->done) {
		snprintf(stage->progress_what, sizeof stage->progress_what, "%s", what);
		stage->what_s = now;
		stage->what_done = done;
		stage->progress_shown = -1;
	}
	stage->done = done;
	bool tty = isatty(STDERR_FILENO);
	int tenths = total > 0 ? (int)(10LL * done / total) : 10;
	if (stage->quiet || done <= 0 || passed < 1)
		return;
	if (tty ? now - stage->progress_s < 0.1 && done < total : tenths == stage->progress_shown)
		return;
	stage->progress_s = now;
	stage->progress_shown = tenths;
	const int since = done - stage->what_done;
	char left[40] = "";
	if (since > 0 && total > done)
		snprintf(left, sizeof left, ", about %.0f s left", (now - stage->what_s) * (total - done) / since);
	if (!tty) {
		stage_note(stage, "%s: %d of %d%s", what, done, total, left);
		return;
	}
	fprintf(stderr, "\r%s: %s [%.*s%.*s] %d/%d%s \033[K", stage->name, what, 2 * tenths,
	        "####################", 20 - 2 * tenths, "....................", done, total, left);
	stage->progress_open = true;
	if (done >= total)
		end_line(stage);
}

void stage_figure(struct stage *stage, const char *key, double value, const char *unit)
{
	(void)stage;
	pthread_mutex_lock(&busy);
	say_log_figure(key, value, unit);
	pthread_mutex_unlock(&busy);
}

/* Formats and logs the sentence; free(). */
static char *skip(const char *fmt, va_list ap)
{
	char *text = 0;
	if (vasprintf(&text, fmt, ap) < 0)
		text = mem_str("");
	pthread_mutex_lock(&busy);
	say_log_skipped(text);
	pthread_mutex_unlock(&busy);
	return text;
}

void stage_skipped(struct stage *stage, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	char *text = skip(fmt, ap);
	va_end(ap);
	stage_note(stage, "skipped: %s", text);
	free(text);
}

void stage_skipped_as_said(struct stage *stage, const char *fmt, ...)
{
	va_list ap;
	(void)stage;
	va_start(ap, fmt);
	free(skip(fmt, ap));
	va_end(ap);
}

int stage_end(struct stage *stage, struct err *err)
{
	double seconds = now_s() - stage->start_s;
	bool ok = !err_is(err);
	end_line(stage);
	struct err late = { 0 };
	if (stage->only)
		record_keep(stage->record);
	else if (ok)
		record_put_aside(stage->record, "work", &late);
	if ((!record_save(stage->record, ok && !stage->only && !err_is(&late), &late) || err_is(&late)) && ok)
		*err = late;
	if (!stage->only)
		say_log_write(stage_path(stage, "work/log/%s.json", stage->name), stage->name, seconds, err->msg);
	if (err_is(err))
		say_error(stage->name, err->msg);
	else
		stage_note(stage, "done in %.2f s", seconds);
	for (int i = 0; i < stage->n_strings; i++)
		free(stage->strings[i]);
	free(stage->strings);
	record_free(stage->record);
	opt_free(stage->n_opts, stage->opts);
	conf_free(&stage->conf);
	if (stage->lock >= 0)
		close(stage->lock);
	return err_is(err) ? 1 : 0;
}
