#include "stages/plan/mirror.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"

static bool is_below(const char *path, const char *folder)
{
	const size_t n = strlen(folder);
	return !strncmp(path, folder, n) && (!path[n] || path[n] == '/' || n == 1);
}

/* Where a link leads, as it is written; "" for what is no link. free(). */
static char *target_of(const char *path)
{
	char to[PATH_MAX];
	const ssize_t n = readlink(path, to, sizeof to - 1);
	return mem_printf("%.*s", n > 0 ? (int)n : 0, to);
}

static bool link_one(const char *capture, const char *source, const char *name, struct err *err)
{
	struct stat st;
	char *path = mem_printf("%s/%s", capture, name), *to = mem_printf("%s/%s", source, name), *was = target_of(path);
	bool ok = !strcmp(was, to);
	if (!ok && !lstat(path, &st) && !S_ISLNK(st.st_mode))
		err_set(err, "%s: is no link to %s: WORK must name a folder of its own", path, to);
	else if (!ok)
		ok = file_remove(path, err) && (!symlink(to, path) || err_set(err, "%s: %s", path, strerror(errno)));
	free(path);
	free(to);
	free(was);
	return ok;
}

/* Removes links to what is no longer there. */
static bool drop_gone(const char *capture, const char *source, struct err *err)
{
	struct file_list list;
	bool ok = file_list(&list, capture, err);
	for (int i = 0; i < list.n && ok; i++) {
		char *path = mem_printf("%s/%s", capture, list.names[i]), *to = target_of(path);
		if (*to && is_below(to, source) && !file_exists(path))
			ok = file_remove(path, err);
		free(path);
		free(to);
	}
	file_list_free(&list);
	return ok;
}

static bool mirror(const char *capture, const char *source, struct err *err)
{
	struct file_list list;
	bool ok = drop_gone(capture, source, err) && file_list(&list, source, err);
	if (!ok)
		return false;
	for (int i = 0; i < list.n && ok; i++)
		ok = !strcmp(list.names[i], "work") || link_one(capture, source, list.names[i], err);
	file_list_free(&list);
	return ok;
}

bool plan_mirror(const char *capture, const char *source, struct err *err)
{
	struct stat st;
	if (stat(source, &st) || !S_ISDIR(st.st_mode))
		return err_set(err, "%s: no such folder", source);
	if (!file_mkdirs(capture, err))
		return false;
	char *from = realpath(source, 0), *to = realpath(capture, 0);
	bool ok = from && to;
	if (!ok)
		err_set(err, "%s: %s", from ? capture : source, strerror(errno));
	else if (is_below(to, from) || is_below(from, to))
		ok = err_set(err, "%s: WORK and the capture must not lie in each other", capture);
	else
		ok = mirror(to, from, err);
	free(from);
	free(to);
	return ok;
}
