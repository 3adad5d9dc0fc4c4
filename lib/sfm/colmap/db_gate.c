#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/gate.h"
#include "sfm/colmap/db_impl.h"

static int open_behind(const char *path, int flags, int mode)
{
	const char *name;
	const int folder = gate_parent(&name, path, false);
	const int fd = folder < 0 ? -1 : openat(folder, name, flags | O_NOFOLLOW | O_CLOEXEC, mode);
	if (folder >= 0)
		close(folder);
	return fd;
}

static int unlink_behind(const char *path)
{
	const char *name;
	const int folder = gate_parent(&name, path, false), bad = folder < 0 ? -1 : unlinkat(folder, name, 0);
	if (folder >= 0)
		close(folder);
	return bad;
}

/* SQLite would put what a link leads to in the link's place before it opens that. */
static int no_link(const char *path, struct stat *st)
{
	return stat(path, st);
}

void db_gate(void)
{
	sqlite3_vfs *files = sqlite3_vfs_find("unix");
	if (!files || files->iVersion < 3)
		return;
	files->xSetSystemCall(files, "open", (sqlite3_syscall_ptr)open_behind);
	files->xSetSystemCall(files, "unlink", (sqlite3_syscall_ptr)unlink_behind);
	files->xSetSystemCall(files, "lstat", (sqlite3_syscall_ptr)no_link);
}
