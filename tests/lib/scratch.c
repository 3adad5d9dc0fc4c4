#include "tests/lib/scratch.h"

#include <ftw.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/mem.h"

static char *root;

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)kind;
	(void)ftw;
	return remove(path);
}

char *scratch_folder(void)
{
	const char *tmp = getenv("TMPDIR");
	char *folder = mem_printf("%s/eyewright-test-XXXXXX", tmp && *tmp ? tmp : "/tmp");
	if (!mkdtemp(folder)) {
		perror(folder);
		exit(1);
	}
	return folder;
}

void scratch_folder_remove(char *folder)
{
	nftw(folder, remove_one, 32, FTW_DEPTH | FTW_PHYS);
	free(folder);
}

const char *scratch_open(void)
{
	return root = scratch_folder();
}

void scratch_close(void)
{
	scratch_folder_remove(root);
	root = 0;
}

int scratch_setup(void **state)
{
	(void)state;
	scratch_open();
	return 0;
}

int scratch_teardown(void **state)
{
	(void)state;
	scratch_close();
	return 0;
}

const char *scratch_path(const char *fmt, ...)
{
	static char ring[8][4096];
	static int next;
	char *path = ring[next++ % COUNT(ring)];
	va_list ap;
	va_start(ap, fmt);
	int n = snprintf(path, sizeof ring[0], "%s/", root);
	vsnprintf(path + n, sizeof ring[0] - (size_t)n, fmt, ap);
	va_end(ap);
	return path;
}

const char *scratch_write(const char *rel, const void *data, size_t size)
{
	struct err err = { 0 };
	const char *path = scratch_path("%s", rel);
	if (!file_write(path, data, size, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	return path;
}

const char *scratch_text(const char *rel, const char *text)
{
	return scratch_write(rel, text, strlen(text));
}
