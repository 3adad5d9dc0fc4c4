#include "base/asked.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

static pthread_mutex_t busy = PTHREAD_MUTEX_INITIALIZER;
static char *folder;
static size_t folder_n;
static char **paths;  // as they were asked for
static int n, room;
static char *trouble;  // the first file that a disk has failed to give

void asked_watch(const char *dir)
{
	pthread_mutex_lock(&busy);
	free(folder);
	folder = mem_str(dir);
	folder_n = strlen(dir);
	pthread_mutex_unlock(&busy);
}

static bool is_known(const char *path)
{
	for (int i = n - 1; i >= 0; i--)
		if (!strcmp(paths[i], path))
			return true;
	return false;
}

void asked_in_vain(const char *path, int why)
{
	pthread_mutex_lock(&busy);
	if (folder && !strncmp(path, folder, folder_n) && path[folder_n] == '/') {
		if (why != ENOENT && why != ENOTDIR) {
			if (!trouble && (why == EIO || why == ENOMEM || why == EMFILE || why == ENFILE || why == ESTALE))
				trouble = mem_str(path);
		} else if (!is_known(path)) {
			if (n == room)
				paths = mem_grow(paths, (size_t)(room = room ? 2 * room : 16), sizeof *paths);
			paths[n++] = mem_str(path);
		}
	}
	pthread_mutex_unlock(&busy);
}

static int by_name(const void *a, const void *b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

void asked_absent(void (*f)(void *ctx, const char *rel), void *ctx)
{
	pthread_mutex_lock(&busy);
	if (n)
		qsort(paths, (size_t)n, sizeof *paths, by_name);
	for (int i = 0; i < n; i++)
		if (access(paths[i], F_OK))
			f(ctx, paths[i] + folder_n + 1);
	pthread_mutex_unlock(&busy);
}

const char *asked_trouble(void)
{
	pthread_mutex_lock(&busy);
	const char *file = trouble;
	pthread_mutex_unlock(&busy);
	return file;
}
