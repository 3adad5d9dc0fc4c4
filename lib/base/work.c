#include "base/work.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"

/* nftw hands nothing on to what it calls. */
static _Thread_local char *link_found;

static int find_link(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)ftw;
	struct stat to;
	if (kind != FTW_SL || stat(path, &to) || !S_ISDIR(to.st_mode))
		return 0;
	link_found = mem_str(path);
	return 1;
}

bool work_check(const char *capture, struct err *err)
{
	char *inside = mem_printf("%s/work", capture);
	link_found = 0;
	nftw(inside, find_link, 32, FTW_PHYS);
	free(inside);
	if (!link_found)
		return true;
	err_set(err, "%s: is a link to another folder: only work/ is written; remove it", link_found);
	free(link_found);
	return false;
}

int work_lock(const char *capture, bool *busy, struct err *err)
{
	char *dir = mem_printf("%s/work/.made", capture), *path = mem_printf("%s/lock", dir);
	int fd = -1;
	if (work_check(capture, err) && file_mkdirs(dir, err)) {
		fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
		if (fd < 0)
			err_set(err, "%s: %s", path, strerror(errno));
		*busy = fd >= 0 && flock(fd, LOCK_EX | LOCK_NB);
	}
	free(dir);
	free(path);
	return fd;
}

void work_wait(int lock)
{
	while (flock(lock, LOCK_EX) && errno == EINTR)
		;
}

static int sweep_one(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	if (kind != FTW_F || !file_is_temporary(path + ftw->base))
		return 0;
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (fd >= 0 && !flock(fd, LOCK_EX | LOCK_NB))
		unlink(path);
	if (fd >= 0)
		close(fd);
	return 0;
}

void work_sweep(const char *capture)
{
	char *work = mem_printf("%s/work", capture);
	nftw(work, sweep_one, 32, FTW_PHYS);
	free(work);
}
