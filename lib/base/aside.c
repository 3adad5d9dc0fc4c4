#include "base/aside.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/gate.h"
#include "base/gate_walk.h"
#include "base/mem.h"

static const char work[] = "work/", put[] = "work/.made/aside/";

char *aside_of(const char *rel)
{
	return mem_printf("%s%s", put, strncmp(rel, work, strlen(work)) ? rel : rel + strlen(work));
}

static bool may_move(const char *rel)
{
	return file_is_relative(rel) && !strncmp(rel, work, strlen(work)) && rel[strlen(work)] && strncmp(rel, "work/.made/", 11) != 0;
}

/* Moves a regular file; what stands in its new place is kept unless `over`. False, errno set; ENOENT: there is none. */
static bool move(const char *from, const char *to, bool over)
{
	struct stat st;
	const char *old, *new;
	const int a = gate_parent(&old, from, false);
	const bool there = a >= 0 && !fstatat(a, old, &st, AT_SYMLINK_NOFOLLOW) && S_ISREG(st.st_mode);
	const int b = there ? gate_parent(&new, to, true) : -1;
	const bool free_place = b >= 0 && (over || fstatat(b, new, &st, AT_SYMLINK_NOFOLLOW));
	const bool ok = free_place && !renameat(a, old, b, new);
	const int why = a >= 0 && !there ? ENOENT : b >= 0 && !free_place ? EEXIST : errno;
	if (a >= 0)
		close(a);
	if (b >= 0)
		close(b);
	errno = why;
	return ok;
}

/* Removes the folders above a file that has gone, as far as they are empty. */
static void tidy(const char *capture, const char *rel, const char *top)
{
	char *dir = mem_str(rel), *slash;
	while ((slash = strrchr(dir, '/')) && strlen(dir) > strlen(top)) {
		*slash = 0;
		char *path = strlen(dir) > strlen(top) ? mem_printf("%s/%s", capture, dir) : 0;
		const bool gone = path && gate_rmdir(path);
		free(path);
		if (!gone)
			break;
	}
	free(dir);
}

/* Moves a file of the capture and tidies up where it was. */
static bool carry(const char *capture, const char *from_rel, const char *to_rel, bool over, const char *top)
{
	char *from = mem_printf("%s/%s", capture, from_rel), *to = mem_printf("%s/%s", capture, to_rel);
	const bool ok = move(from, to, over);
	const int why = errno;
	if (ok)
		tidy(capture, from_rel, top);
	free(from);
	free(to);
	errno = why;
	return ok;
}

bool aside_put(const char *capture, const char *rel, struct err *err)
{
	if (!may_move(rel))
		return true;
	char *to = aside_of(rel);
	const bool ok = carry(capture, rel, to, true, work) || errno == ENOENT
	                || err_set(err, "%s/%s: is of an earlier state of the capture, and cannot be put aside: %s", capture, rel, strerror(errno));
	free(to);
	return ok;
}

bool aside_take(const char *capture, const char *rel)
{
	if (!may_move(rel))
		return false;
	char *from = aside_of(rel);
	const bool ok = carry(capture, from, rel, false, put);
	free(from);
	return ok;
}

bool aside_drop(const char *capture, const char *rel, struct err *err)
{
	if (!may_move(rel))
		return true;
	char *gone = aside_of(rel), *path = mem_printf("%s/%s", capture, gone);
	const bool ok = file_remove(path, err);
	tidy(capture, gone, put);
	free(gone);
	free(path);
	return ok;
}

/* A stage's record, which no record names. free() */
static char *record_of(const char *stage, bool away)
{
	return mem_printf("%s%s.json", away ? "work/.made/aside/.made/" : "work/.made/", stage);
}

bool aside_stands(const char *capture, const char *stage, bool away)
{
	char *rel = record_of(stage, away), *path = mem_printf("%s/%s", capture, rel);
	const bool there = access(path, F_OK) == 0;
	free(rel);
	free(path);
	return there;
}

bool aside_move_record(const char *capture, const char *stage, bool away, struct err *err)
{
	char *from = record_of(stage, !away), *to = record_of(stage, away);
	const bool ok = carry(capture, from, to, away, "work/.made/") || errno == ENOENT
	                || err_set(err, "%s/%s: cannot be moved to %s: %s", capture, from, to, strerror(errno));
	free(from);
	free(to);
	return ok;
}
