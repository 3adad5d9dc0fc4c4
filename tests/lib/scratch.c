#include "tests/lib/scratch.h"

#include <ftw.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/mem.h"

static char root[64];

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)kind;
	(void)ftw;
	return remove(path);
}

const char *scratch_open(void)
{
	strcpy(root, "/tmp/eyewright-test-XXXXXX");
	if (!mkdtemp(root)) {
		perror(root);
		exit(1);
	}
	return root;
}

void scratch_close(void)
{
	nftw(root, remove_one, 32, FTW_DEPTH | FTW_PHYS);
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
