/* summary: the table and the page of many captures.
 * reads   DIR/NAME/work of the captures named on standard input; DIR/batch/results, rows
 * writes  DIR/batch/rows, thumbs; index.html, summary.csv, summary.json
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/call.h"
#include "base/file.h"
#include "base/gate.h"
#include "base/guard.h"
#include "base/mem.h"
#include "base/say.h"
#include "summary.h"

#define ABOUT "a table and a page of many captures; DIR is the folder that holds them\n\n" \
	"  --collect          first read the captures whose names stand on standard input, a zero byte behind each\n" \
	"  --only-collect     that alone\n" \
	"  --now-and-then     write table and page only when they are older than 5 s and 0.03 s for each capture\n" \
	"  --queued=FILE      what a scheduler knows of captures without a result: lines NAME, STATE, REASON, tabs between"

struct asked {
	bool collect, write, now_and_then;
	const char *queued;
};

static struct asked take_asked(int *argc, char **argv)
{
	struct asked asked = { .write = true };
	int n = 1;
	for (int i = 1; i < *argc; i++)
		if (!strcmp(argv[i], "--collect"))
			asked.collect = true;
		else if (!strcmp(argv[i], "--only-collect"))
			asked.collect = true, asked.write = false;
		else if (!strcmp(argv[i], "--now-and-then"))
			asked.now_and_then = true;
		else if (!strncmp(argv[i], "--queued=", 9))
			asked.queued = argv[i] + 9;
		else
			argv[n++] = argv[i];
	argv[*argc = n] = 0;
	return asked;
}

static bool collect(const char *dir, const struct summary_conf *conf, struct err *err)
{
	char *name = 0;
	size_t size = 0;
	bool ok = true;
	while (ok && getdelim(&name, &size, 0, stdin) > 0)
		if (*name && !strchr(name, '/') && strcmp(name, ".") && strcmp(name, ".."))
			ok = summary_collect(dir, name, conf, err);
	free(name);
	return ok;
}

/* True when the page is older than 5 s and 30 ms for each capture: writing it does not slow a large batch down. */
static bool is_due(const char *dir)
{
	struct stat page, list;
	char *path = mem_printf("%s/batch/index.html", dir), *names = mem_printf("%s/batch/results", dir);
	struct file_list results = { 0 };
	struct err none = { 0 };
	bool due = stat(path, &page) || stat(names, &list) || !file_list(&results, names, &none)
	           || difftime(time(0), page.st_mtime) > 5 + 0.03 * results.n || page.st_mtime > time(0);
	file_list_free(&results);
	free(path);
	free(names);
	return due;
}

static bool write_all(const char *dir, const char *queued, const struct summary_conf *conf, struct err *err)
{
	json_t *captures = summary_all(dir, queued, conf, err);
	const char *slash = strrchr(dir, '/');
	char *path[] = { mem_printf("%s/batch/summary.csv", dir), mem_printf("%s/batch/summary.json", dir), mem_printf("%s/batch/index.html", dir) };
	bool ok = captures && summary_csv(captures, path[0], err) && summary_json(captures, path[1], err)
	          && summary_page(captures, slash && slash[1] ? slash + 1 : dir, path[2], err);
	for (int i = 0; i < COUNT(path); i++)
		free(path[i]);
	json_decref(captures);
	return ok;
}

static bool summary(const char *dir, const struct asked *asked, const struct summary_conf *conf, struct err *err)
{
	char *batch = mem_printf("%s/batch", dir);
	struct stat st;
	bool ok = !lstat(batch, &st) && S_ISDIR(st.st_mode);
	if (!ok)
		err_set(err, "%s: is not there, or a link: make batch makes it", batch);
	else if ((ok = gate_set(batch, err)))
		guard_enter(batch, 0, false);
	free(batch);
	return ok && (!asked->collect || collect(dir, conf, err))
	       && (!asked->write || (asked->now_and_then && !is_due(dir)) || write_all(dir, asked->queued, conf, err));
}

int main(int argc, char **argv)
{
	struct summary_conf of;
	const struct opt opts[] = {
		OPT_REAL("doubt_gross", &of.gross, 0, 1, "", "doubtful: a limbus that is likelier than this to be wrong"),
		OPT_REAL("doubt_theta_deg", &of.theta_deg, 0, 90, "deg", "doubtful: a standard deviation of the eye's tilt above this"),
		OPT_REAL("doubt_difference", &of.difference, 0, 100, "CIEDE2000", "doubtful: a rendering that differs more from its photograph"),
		OPT_INT("thumb_px", &of.thumb_px, 16, 1024, "px", "width of the page's pictures"),
	};
	struct asked asked = take_asked(&argc, argv);
	struct call call;
	struct conf conf = { 0 };
	struct err err = { 0 };
	call_parse(&call, "summary", ABOUT, argc, argv, COUNT(opts), opts, &conf);
	if (call_load(&call, "summary", &conf, &err) && opt_resolve("summary", COUNT(opts), opts, &conf, &err)) {
		if (call.print_config)
			opt_print(stdout, "summary", COUNT(opts), opts, &conf);
		else
			summary(call.capture, &asked, &of, &err);
	}
	conf_free(&conf);
	if (err_is(&err))
		say_error("summary", err.msg);
	return !err_is(&err) ? 0 : err.usage ? 2 : 1;
}
