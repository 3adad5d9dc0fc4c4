#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/say.h"
#include "plan.h"

/* Both streams of a child, in memory: no file is made for what is read at once. */
struct said {
	int out, err;
};

/* Plans one capture and leaves. Of captures that are read elsewhere the environment names the folder that holds them. */
_Noreturn static void be_child(const struct said *said, struct call call, const char *name, const struct opt opts[PLAN_OPTS],
                               const struct plan_cost cost[PLAN_STAGES], struct conf *conf)
{
	const struct plan_asked asked = { .request = true };
	const char *source = getenv("EYEWRIGHT_SOURCE");
	call.capture = mem_printf("%s/%s", call.capture, name);
	if (source && *source)
		setenv("EYEWRIGHT_SOURCE", mem_printf("%s/%s", source, name), 1);
	dup2(said->out, STDOUT_FILENO);
	dup2(said->err, STDERR_FILENO);
	const int status = plan_run(&call, &asked, opts, cost, conf, &(struct err){ 0 });
	fflush(stdout);
	_exit(status);
}

/* What a child wrote there, without newlines at its end; free(). */
static char *take(int fd)
{
	const off_t size = lseek(fd, 0, SEEK_END);
	char *text = mem_new((size_t)(size > 0 ? size : 0) + 1, 1);
	ssize_t n = size > 0 ? pread(fd, text, (size_t)size, 0) : 0;
	while (n > 0 && text[n - 1] == '\n')
		text[--n] = 0;
	return text;
}

/* Prints the line of one capture: its status; the request with tabs for newlines, or the last line of what went wrong. */
static void tell(const struct said *said, int status)
{
	char *text = take(status == 0 || status == 3 ? said->out : said->err), *line = text, *last;
	if (status != 0 && status != 3 && (last = strrchr(text, '\n')))
		line = last + 1;
	for (char *c = line; *c; c++)
		*c = *c == '\n' ? '\t' : *c;
	printf("%d\t%s\n", status, line);
	free(text);
}

/* A process for each: what one capture does to it is not felt by the next. */
static bool look_into(const struct call *call, const char *name, const struct opt opts[PLAN_OPTS],
                      const struct plan_cost cost[PLAN_STAGES], struct conf *conf, struct err *err)
{
	const struct said said = { memfd_create("out", MFD_CLOEXEC), memfd_create("err", MFD_CLOEXEC) };
	int how = 0;
	fflush(stdout);
	const pid_t pid = said.out < 0 || said.err < 0 ? -1 : fork();
	if (!pid)
		be_child(&said, *call, name, opts, cost, conf);
	bool ok = pid > 0 || err_set(err, "%s/%s: cannot be looked into: %s", call->capture, name, strerror(errno));
	while (ok && waitpid(pid, &how, 0) < 0 && errno == EINTR)
		;
	if (ok && WIFSIGNALED(how))
		dprintf(said.err, "plan: ended by signal %d (%s)\n", WTERMSIG(how), strsignal(WTERMSIG(how)));
	if (ok)
		tell(&said, WIFEXITED(how) ? WEXITSTATUS(how) : 1);
	close(said.out);
	close(said.err);
	return ok;
}

int plan_many(const struct call *call, const struct opt opts[PLAN_OPTS], const struct plan_cost cost[PLAN_STAGES], struct conf *conf,
              struct err *err)
{
	char **names = 0, *name = 0;
	size_t room = 0;
	int n = 0;
	// All of them before the first child: it would share the place in what is read.
	while (getdelim(&name, &room, 0, stdin) > 0) {
		names = mem_grow(names, (size_t)n + 1, sizeof *names);
		names[n++] = mem_str(name);
	}
	bool ok = true;
	for (int i = 0; i < n; i++) {
		ok = ok && look_into(call, names[i], opts, cost, conf, err);
		free(names[i]);
	}
	free(names);
	free(name);
	if (!ok)
		say_error("plan", err->msg);
	return ok ? 0 : 1;
}
