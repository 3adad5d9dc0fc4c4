#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/gate.h"
#include "base/gate_walk.h"
#include "base/mem.h"
#include "plan.h"

static bool remove_one(void *ctx, int folder, const char *name, bool is_folder)
{
	(void)ctx;
	return !unlinkat(folder, name, is_folder ? AT_REMOVEDIR : 0) || errno == ENOENT;
}

/* True when a running stage holds the lock (base/stage.c). */
static bool is_busy(const char *work)
{
	char *path = mem_printf("%s/.made/lock", work);
	const char *name;
	const int folder = gate_parent(&name, path, false), fd = folder < 0 ? -1 : openat(folder, name, O_RDWR | O_CLOEXEC | O_NOFOLLOW);
	bool busy = fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK;
	if (fd >= 0)
		close(fd);
	if (folder >= 0)
		close(folder);
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
	else if (!gate_set(work, err))
		ok = false;
	else if (is_busy(work))
		ok = err_set(err, "%s: a stage is running there: wait for it, or end it", work);
	else
		ok = (gate_walk(work, remove_one, 0) && gate_rmdir(work))
		     || err_set(err, "%s: cannot remove: %s", work, strerror(errno));
	free(work);
	return ok;
}
