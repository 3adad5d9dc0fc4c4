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
#include "base/gate.h"
#include "base/gate_walk.h"
#include "base/mem.h"

/* The folder that a search is about, and the first link found that leads out of it: nftw hands nothing on to what it calls. */
static _Thread_local char *root, *link_found;

/* Whether what a link in work/ leads to lies outside of the folder, or is not there. */
static bool leads_out(const char *path)
{
	char *real = realpath(path, 0);
	const size_t n = strlen(root);
	bool out = !real || strncmp(real, root, n) || (real[n] && real[n] != '/' && strcmp(root, "/"));
	free(real);
	return out;
}

static int find_link(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)ftw;
	struct stat to;
	if (kind != FTW_SL || ((!stat(path, &to) && !S_ISDIR(to.st_mode)) && !leads_out(path)))
		return 0;
	link_found = mem_str(path);
	return 1;
}

/* Of what the capture is read from: a link may lead into file_source(), too. */
static bool input_leads_out(const char *path)
{
	char *real = realpath(path, 0);
	const bool out = real && !file_leads_inside(real, root);
	free(real);
	return out;
}

/* A name of the capture, "photos/a.jpg" or "capture.conf". */
static bool is_inside(const char *capture, const char *folder, const char *name, struct err *err)
{
	struct stat st;
	char *path = mem_printf("%s/%s%s%s", capture, folder, *folder ? "/" : "", name);
	bool ok = lstat(path, &st) || !S_ISLNK(st.st_mode) || !input_leads_out(path)
	          || err_set(err, "%s: is a link that leads out of the capture: put the file itself there", path);
	free(path);
	return ok;
}

bool work_check_inputs(const char *capture, struct err *err)
{
	static const char *const names[] = { "capture.conf", "subject.ply", "subject.obj", "photos", "views", "video", "targets", "script" };
	bool ok = true;
	root = realpath(capture, 0);
	for (int i = 0; root && ok && i < COUNT(names); i++) {
		struct err none = { 0 };
		struct file_list list = { 0 };
		ok = is_inside(capture, "", names[i], err);
		char *path = mem_printf("%s/%s", capture, names[i]);
		if (ok && i >= 3)
			file_list(&list, path, &none);
		for (int k = 0; k < list.n && ok; k++)
			ok = is_inside(capture, names[i], list.names[k], err);
		file_list_free(&list);
		free(path);
	}
	free(root);
	return ok;
}

bool work_check(const char *capture, struct err *err)
{
	char *inside = mem_printf("%s/work", capture);
	link_found = 0;
	root = realpath(capture, 0);
	if (root)
		nftw(inside, find_link, 32, FTW_PHYS);
	free(root);
	free(inside);
	if (!link_found)
		return true;
	struct stat to;
	err_set(err, "%s: is a link %s: only work/ is written; remove it", link_found,
	        !stat(link_found, &to) && S_ISDIR(to.st_mode) ? "to another folder" : "that leads out of the capture");
	free(link_found);
	return false;
}

bool work_enter(const char *capture, struct err *err)
{
	char *work = mem_printf("%s/work", capture);
	const bool ok = work_check(capture, err) && file_mkdirs(work, err) && gate_set(work, err);
	free(work);
	return ok;
}

int work_lock(const char *capture, bool *busy, struct err *err)
{
	char *dir = mem_printf("%s/work/.made", capture), *path = mem_printf("%s/lock", dir);
	int fd = -1;
	if (work_enter(capture, err) && file_mkdirs(dir, err)) {
		fd = gate_create(path, O_RDWR);
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

static bool sweep_one(void *ctx, int folder, const char *name, bool is_folder)
{
	(void)ctx;
	if (is_folder || !file_is_temporary(name))
		return true;
	int fd = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (fd >= 0 && !flock(fd, LOCK_EX | LOCK_NB))
		unlinkat(folder, name, 0);
	if (fd >= 0)
		close(fd);
	return true;
}

void work_sweep(const char *capture)
{
	char *work = mem_printf("%s/work", capture);
	gate_walk(work, sweep_one, 0);
	free(work);
}
