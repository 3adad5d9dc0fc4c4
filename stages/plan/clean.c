#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "plan.h"

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)ftw;
	return (kind == FTW_DP ? rmdir(path) : unlink(path)) && errno != ENOENT ? -1 : 0;
}

/* True when a running stage holds the lock (base/stage.c). */
static bool is_busy(const char *work)
{
	char *path = mem_printf("%s/.made/lock", work);
	int fd = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW);
	bool busy = fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK;
	if (fd >= 0)
		close(fd);
	free(path);
	return busy;
}

bool plan_clean(const char *capture, struct err *err)
{
	struct stat st;
	char *work = mem_printf("%s/work", capture);
	bool ok = true;
	if (stat(capture, &st) || !S_ISDIR(st.st_mode))
		ok = err_set(err, "%s: no such folder", capture);
	else if (lstat(work, &st))
		ok = errno == ENOENT ? true : err_set(err, "%s: %s", work, strerror(errno));
	else if (!S_ISDIR(st.st_mode))  // a link is taken away, what it leads to stays
		ok = !unlink(work) || err_set(err, "%s: cannot remove: %s", work, strerror(errno));
	else if (is_busy(work))
		ok = err_set(err, "%s: a stage is running there: wait for it, or end it", work);
	else
		ok = !nftw(work, remove_one, 32, FTW_DEPTH | FTW_PHYS)
		     || err_set(err, "%s: cannot remove: %s", work, strerror(errno));
	free(work);
	return ok;
}
