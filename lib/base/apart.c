#include "base/apart.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/guard.h"
#include "base/mem.h"

enum { SAID_NO = 3 };  // the exit status of a function that returned false; the result is its message then

struct apart_out {
	int fd;
	size_t size, most;
};

bool apart_put(struct apart_out *out, const void *bytes, size_t size)
{
	if (size > out->most - out->size)
		return false;
	for (size_t done = 0; done < size;) {
		const ssize_t n = write(out->fd, (const char *)bytes + done, size - done);
		if (n < 0 && errno != EINTR)
			return false;
		done += n > 0 ? (size_t)n : 0;
	}
	out->size += size;
	return true;
}

/* Bytes of addresses that this process has taken. */
static size_t addresses(void)
{
	unsigned long pages = 0;
	FILE *f = fopen("/proc/self/statm", "r");
	if (f && fscanf(f, "%lu", &pages) != 1)
		pages = 0;
	if (f)
		fclose(f);
	return pages * (size_t)sysconf(_SC_PAGESIZE);
}

_Noreturn static void be_child(int fd, const struct apart *apart)
{
	struct apart_out out = { fd, 0, apart->result };
	struct err err = { 0 };
	const struct guard_apart limits = { apart->reads, addresses() + apart->memory, apart->result + sizeof err.msg,
		                                (long)ceil(apart->seconds) };
	static const int deaths[] = { SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTERM, SIGINT };
	for (int i = 0; i < COUNT(deaths); i++)
		signal(deaths[i], SIG_DFL);  // not what this program does of its own death
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (!freopen("/dev/null", "w", stderr))
		_exit(1);
	guard_apart(&limits);
	if (apart->run(apart->ctx, &out, &err))
		_exit(0);
	if (!ftruncate(fd, 0) && lseek(fd, 0, SEEK_SET) == 0) {
		out = (struct apart_out){ fd, 0, sizeof err.msg };
		apart_put(&out, err.msg, strlen(err.msg));
	}
	_exit(SAID_NO);
}

static double clock_s(clockid_t clock)
{
	struct timespec t = { 0 };
	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Waits for the child, whose processor time is limited already (RLIMIT_CPU); kills it when it stands still. By the clock alone it may
 * take long: on a busy machine sound data does. *late: it was killed. */
static int wait_for(pid_t pid, double seconds, bool *late)
{
	static const double least_share = 1e-3;  // of one processor; 50 processes on each leave twenty times as much
	clockid_t its_time;
	const bool timed = !clock_getcpuclockid(pid, &its_time);
	double since = clock_s(CLOCK_MONOTONIC), used = 0;
	struct timespec nap = { 0, 200000 };
	int status = 0;
	*late = false;
	for (;;) {
		const pid_t got = waitpid(pid, &status, *late ? 0 : WNOHANG);
		if (got == pid || (got < 0 && errno != EINTR))
			return status;
		const double now = clock_s(CLOCK_MONOTONIC), used_now = timed ? clock_s(its_time) : 0;
		if (now - since > seconds + 1 && !*late) {
			*late = used_now - used < least_share * (now - since);
			since = now;
			used = used_now;
			if (*late) {
				kill(pid, SIGKILL);
				continue;
			}
		}
		nanosleep(&nap, 0);
		nap.tv_nsec = nap.tv_nsec < 10000000 ? 2 * nap.tv_nsec : nap.tv_nsec;
	}
}

static bool take(char **data, size_t *size, int fd, size_t most, struct err *err)
{
	struct stat st;
	if (fstat(fd, &st) || st.st_size < 0 || (size_t)st.st_size > most + sizeof err->msg)
		return err_set(err, "its result cannot be read");
	*data = mem_array((size_t)st.st_size + 1, 1);
	for (*size = 0; *size < (size_t)st.st_size;) {
		const ssize_t n = pread(fd, *data + *size, (size_t)st.st_size - *size, (off_t)*size);
		if (n == 0 || (n < 0 && errno != EINTR))
			break;
		*size += n > 0 ? (size_t)n : 0;
	}
	(*data)[*size] = 0;
	return true;
}

/* What became of a child that did not say it itself. */
static bool died(int status, bool late, const struct apart *apart, struct err *err)
{
	const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	if (late || signal == SIGXCPU)
		return err_set(err, "takes longer than %.0f s to read", apart->seconds);
	if (WIFEXITED(status))  // base/mem.h
		return err_set(err, "takes more than %.0f MiB of memory to read, or more than %.0f MiB when read", (double)apart->memory / 1048576,
		               (double)apart->result / 1048576);
	return err_set(err, "cannot be read: its reader died of signal %d (%s)", signal, strsignal(signal));
}

bool apart_run(char **data, size_t *size, const struct apart *apart, struct err *err)
{
	*data = 0;
	*size = 0;
	const int fd = memfd_create("apart", MFD_CLOEXEC);
	if (fd < 0)
		return err_set(err, "no room for its result: %s", strerror(errno));
	const pid_t pid = fork();
	if (pid == 0)
		be_child(fd, apart);
	bool late = false, ok = pid > 0 || err_set(err, "cannot be read: no process for it: %s", strerror(errno));
	if (ok) {
		const int status = wait_for(pid, apart->seconds, &late);
		const bool said = WIFEXITED(status) && (!WEXITSTATUS(status) || WEXITSTATUS(status) == SAID_NO);
		ok = late || !said ? died(status, late, apart, err) : take(data, size, fd, apart->result, err);
		if (ok && WEXITSTATUS(status))
			ok = err_set(err, "%.900s", *data);
	}
	close(fd);
	if (!ok) {
		free(*data);
		*data = 0;
	}
	return ok;
}
