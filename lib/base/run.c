#include "base/run.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/gate.h"
#include "base/mem.h"

extern char **environ;

enum { LINE_MAX_BYTES = 1000 };

struct child {
	const struct run *run;
	pid_t pid;
	int out, log;              // its output; the log
	char line[LINE_MAX_BYTES + 1], reason[LINE_MAX_BYTES + 1];
	int n_line, sure;          // sure: how likely the line kept is the reason of a failure, 0 to 2
	bool disk_full;
};

bool run_exists(const char *name)
{
	const char *path = getenv("PATH");
	bool found = false;
	for (const char *at = path; at && *at && !found; at += *at == ':') {
		size_t n = strcspn(at, ":");
		char *full = mem_printf("%.*s/%s", (int)n, at, name);
		found = n && access(full, X_OK) == 0;
		free(full);
		at += n;
	}
	return found;
}

/* How likely a line of output is the reason of a failure: 2 for a line that names an error (the first such line is the reason,
 * the rest a trace), 1 for a result (the last such line counts). */
static int looks_like_reason(const char *line)
{
	static const char *const words[] = { "ERROR", "Error", "error:", "Check failed", "terminate called", "what():" };
	for (int i = 0; i < COUNT(words); i++)
		if (strstr(line, words[i]))
			return 2;
	return strstr(line, "=>") ? 1 : 0;
}

static void end_of_line(struct child *c)
{
	c->line[c->n_line] = 0;
	c->n_line = 0;
	if (!c->line[strspn(c->line, " ")])
		return;
	c->disk_full |= strstr(c->line, "No space left") || strstr(c->line, "disk is full") || strstr(c->line, "disk I/O error");
	int sure = looks_like_reason(c->line);
	if (sure > c->sure || (sure == 1 && c->sure == 1)) {
		strcpy(c->reason, c->line);
		c->sure = sure;
	}
	if (c->run->line)
		c->run->line(c->run->ctx, c->line);
}

/* Reads the output that is there now. Returns false at its end. */
static bool take_output(struct child *c)
{
	char piece[4096];
	ssize_t n = read(c->out, piece, sizeof piece);
	if (n < 0 && (errno == EINTR || errno == EAGAIN))
		return true;
	if (n > 0 && c->log >= 0 && write(c->log, piece, (size_t)n) < 0)
		c->disk_full |= errno == ENOSPC;
	for (ssize_t i = 0; i < n; i++)
		if (piece[i] == '\n' || piece[i] == '\r')
			end_of_line(c);
		else if (c->n_line < LINE_MAX_BYTES && !iscntrl((unsigned char)piece[i]))
			c->line[c->n_line++] = piece[i];
	if (n <= 0 && c->n_line)
		end_of_line(c);
	return n > 0;
}

/* The environment, variables of the same names replaced by the further settings. */
static char **environment(const char *const *more)
{
	int n = 0, extra = 0, kept = 0;
	while (environ[n])
		n++;
	while (more && more[extra])
		extra++;
	char **env = mem_new((size_t)(n + extra) + 1, sizeof *env);
	for (int i = 0; i < n; i++) {
		bool again = false;
		for (int k = 0; k < extra; k++)
			again |= !strncmp(environ[i], more[k], strcspn(more[k], "=") + 1);
		if (!again)
			env[kept++] = environ[i];
	}
	for (int k = 0; k < extra; k++)
		env[kept++] = (char *)more[k];
	return env;
}

static bool start(struct child *c, const struct run *run, struct err *err)
{
	int ends[2];
	*c = (struct child){ .run = run, .log = -1, .out = -1 };
	if (pipe2(ends, O_CLOEXEC))
		return err_set(err, "%s: %s", run->argv[0], strerror(errno));
	posix_spawn_file_actions_t files;
	posix_spawn_file_actions_init(&files);
	posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
	posix_spawn_file_actions_adddup2(&files, ends[1], STDERR_FILENO);
	if (run->dir)
		posix_spawn_file_actions_addchdir_np(&files, run->dir);
	char **env = environment(run->env);
	int why = posix_spawnp(&c->pid, run->argv[0], &files, 0, (char *const *)run->argv, env);
	free(env);
	posix_spawn_file_actions_destroy(&files);
	close(ends[1]);
	if (why) {
		close(ends[0]);
		c->pid = 0;
		if (why == ENOENT)
			return err_set(err, "%s is not installed: %s", run->argv[0], run->install ? run->install : "install it");
		return err_set(err, "%s: cannot be started: %s", run->argv[0], strerror(why));
	}
	c->out = ends[0];
	c->log = gate_create(run->log, O_WRONLY | O_APPEND);
	return true;
}

/* Whether the disk that the log is on is full. */
static bool disk_is_full(const char *log)
{
	struct statvfs fs;
	char *dir = mem_str(log), *slash = strrchr(dir, '/');
	if (slash)
		*slash = 0;
	bool full = !statvfs(slash ? dir : ".", &fs) && (double)fs.f_bavail * (double)fs.f_frsize < 1 << 20;
	free(dir);
	return full;
}

static bool finish(struct child *c, struct err *err)
{
	int status = 0;
	const char *program = c->run->argv[0], *task = c->run->argv[1] ? c->run->argv[1] : "";
	while (waitpid(c->pid, &status, 0) < 0 && errno == EINTR)
		;
	close(c->out);
	if (c->log >= 0)
		close(c->log);
	if (WIFEXITED(status) && !WEXITSTATUS(status) && !c->disk_full)
		return true;
	if (c->disk_full || disk_is_full(c->run->log))
		return err_set(err, "%s %s: the disk is full; make room and run again: what is done is kept", program, task);
	if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
		return err_set(err, "%s %s: was killed, perhaps for want of memory; what was done before is kept", program, task);
	const char *reason = *c->reason ? c->reason : "it does not say why";
	if (WIFSIGNALED(status))
		return err_set(err, "%s %s: ended by signal %d (%s): %.200s; all it said: %s", program, task, WTERMSIG(status),
		               strsignal(WTERMSIG(status)), reason, c->run->log);
	return err_set(err, "%s %s: failed: %.200s; all it said: %s", program, task, reason, c->run->log);
}

/* Waits until one of the running children writes output or ends. */
static bool attend(struct child children[], int n, int *running, struct err *err)
{
	struct pollfd *fds = mem_new((size_t)n, sizeof *fds);
	for (int i = 0; i < n; i++)
		fds[i] = (struct pollfd){ .fd = children[i].pid > 0 ? children[i].out : -1, .events = POLLIN };
	bool ok = true;
	if (poll(fds, (nfds_t)n, -1) > 0)
		for (int i = 0; i < n; i++)
			if (fds[i].fd >= 0 && fds[i].revents && !take_output(&children[i])) {
				ok &= finish(&children[i], err);
				children[i].pid = 0;
				--*running;
			}
	free(fds);
	return ok;
}

bool run_programs(int n, const struct run runs[], int threads, struct err *err)
{
	struct child *children = mem_new((size_t)n, sizeof *children);
	int next = 0, running = 0;
	bool ok = true;
	while (running || (ok && next < n)) {
		while (ok && next < n && running < threads) {
			ok = start(&children[next], &runs[next], err);
			running += ok;
			next++;
		}
		if (running)
			ok &= attend(children, next, &running, err);
	}
	free(children);
	return ok;
}

bool run_program(const struct run *run, struct err *err)
{
	return run_programs(1, run, 1, err);
}
