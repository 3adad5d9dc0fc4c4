#include "base/gate_walk.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "base/gate.h"

enum { FOLDER = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC };

/* Walks what stands in the folder `at`, which is closed. why: the first errno of what failed; kept where it is set. */
static void walk(int at, gate_visit *visit, void *ctx, int *why)
{
	DIR *dir = fdopendir(at);
	if (!dir) {
		*why = *why ? *why : errno;
		close(at);
		return;
	}
	for (struct dirent *e; (e = readdir(dir));) {
		if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, ".."))
			continue;
		const bool may = e->d_type == DT_DIR || e->d_type == DT_UNKNOWN;
		const int below = may ? openat(at, e->d_name, FOLDER) : -1;
		if (below < 0 && e->d_type == DT_DIR && errno != ENOENT)
			*why = *why ? *why : errno;
		if (below >= 0)
			walk(below, visit, ctx, why);
		if (!visit(ctx, at, e->d_name, below >= 0 || e->d_type == DT_DIR) && !*why)
			*why = errno;
	}
	closedir(dir);
}

bool gate_walk(const char *dir, gate_visit *visit, void *ctx)
{
	const int folder = gate_folder(dir, false), at = folder >= 0 ? openat(folder, ".", FOLDER) : -1;
	int why = at < 0 ? errno : 0;
	if (folder >= 0)
		close(folder);
	if (at >= 0)
		walk(at, visit, ctx, &why);
	errno = why;
	return !why;
}

bool gate_rmdir(const char *dir)
{
	const char *name;
	const int folder = gate_parent(&name, dir, false);
	const bool ok = folder >= 0 && !unlinkat(folder, name, AT_REMOVEDIR);
	const int why = errno;
	if (folder >= 0)
		close(folder);
	errno = why;
	return ok;
}
