#include "base/gate.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/mem.h"

/* Set once: where everything that is written has to pass. */
static struct {
	char *path;
	size_t n;
	int fd;
} gate = { .fd = -1 };

enum { FOLDER = O_PATH | O_DIRECTORY | O_CLOEXEC };

bool gate_set(const char *folder, struct err *err)
{
	const int fd = open(folder, FOLDER | O_NOFOLLOW);
	if (fd < 0)
		return err_set(err, "%s: %s", folder, strerror(errno));
	if (gate.fd >= 0)
		close(gate.fd);
	free(gate.path);
	gate.path = mem_str(folder);
	gate.n = strlen(folder);
	gate.fd = fd;
	return true;
}

/* What stands behind the gate's folder, without a slash before it; null: another path. */
static const char *behind(const char *dir)
{
	if (gate.fd < 0 || strncmp(dir, gate.path, gate.n) || (dir[gate.n] && dir[gate.n] != '/'))
		return 0;
	return dir + gate.n + strspn(dir + gate.n, "/");
}

/* In one call, where the kernel has it (Linux 5.6). */
static int open_at_once(const char *rel)
{
	const struct open_how how = { .flags = FOLDER, .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS };
	return (int)syscall(SYS_openat2, gate.fd, rel, &how, sizeof how);
}

/* The folder `name` of the folder `at`, which is closed. */
static int step(int at, const char *name, bool make)
{
	const bool up = !strcmp(name, "..");
	const int made = make && !up && mkdirat(at, name, 0777) ? errno : 0;
	const int fd = up ? -1 : openat(at, name, FOLDER | O_NOFOLLOW), why = up ? ELOOP : errno;
	close(at);
	errno = fd < 0 && why == ENOENT && made ? made : why;
	return fd;
}

static int open_by_levels(const char *rel, bool make)
{
	char *parts = mem_str(rel), *rest = parts;
	int fd = openat(gate.fd, ".", FOLDER);
	for (char *part; fd >= 0 && (part = strsep(&rest, "/"));)
		if (*part && strcmp(part, "."))
			fd = step(fd, part, make);
	const int why = errno;
	free(parts);
	errno = why;
	return fd;
}

/* mkdir -p. Returns why the last of them could not be made, or 0. */
static int make_all(const char *dir)
{
	char *path = mem_str(dir);
	int why = 0;
	for (char *p = path + 1; *path; p++) {
		const char c = *p;
		if (c != '/' && c)
			continue;
		*p = 0;
		why = mkdir(path, 0777) ? errno : 0;
		if (!c)
			break;
		*p = '/';
	}
	free(path);
	return why == EEXIST ? 0 : why;
}

int gate_folder(const char *dir, bool make)
{
	const char *rel = behind(dir);
	if (!rel) {
		int fd = open(dir, FOLDER);
		if (fd < 0 && errno == ENOENT && make) {
			const int why = make_all(dir);
			fd = open(dir, FOLDER);
			if (fd < 0 && why)
				errno = why;
		}
		return fd;
	}
	const int fd = *rel ? open_at_once(rel) : -1;
	if (fd >= 0 || (*rel && errno != ENOENT && errno != ENOSYS && errno != EPERM && errno != EAGAIN))
		return fd;
	return open_by_levels(rel, make);
}

int gate_parent(const char **name, const char *path, bool make)
{
	const char *slash = strrchr(path, '/');
	*name = slash ? slash + 1 : path;
	char *dir = slash ? mem_printf("%.*s", slash == path ? 1 : (int)(slash - path), path) : mem_str(".");
	const int fd = gate_folder(dir, make), why = errno;
	free(dir);
	errno = why;
	return fd;
}

int gate_create(const char *path, int flags)
{
	const char *name;
	const int folder = gate_parent(&name, path, true);
	if (folder < 0)
		return -1;
	const int fd = openat(folder, name, flags | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666), why = errno;
	close(folder);
	errno = why;
	return fd;
}

bool gate_rename(const char *from, const char *to)
{
	const char *old, *new = strrchr(to, '/');
	const int folder = gate_parent(&old, from, false);
	const bool ok = folder >= 0 && !renameat(folder, old, folder, new ? new + 1 : to);
	const int why = errno;
	if (folder >= 0)
		close(folder);
	errno = why;
	return ok;
}
