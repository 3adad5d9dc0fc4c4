#include "tests/fuzz/capture/folder.h"

#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool name_is_fine(const char *name, size_t n)
{
	if (!n || n >= FOLDER_NAME || name[0] == '/' || memchr(name, 0, n))
		return false;
	for (const char *at = name; at && at < name + n; at = memchr(at, '/', (size_t)(name + n - at)), at = at ? at + 1 : 0)
		if (name + n - at >= 2 && at[0] == '.' && at[1] == '.')
			return false;
	return true;
}

void folder_parse(struct folder *f, const uint8_t *data, size_t size)
{
	const char *at = (const char *)data, *end = at + size;
	f->n = 0;
	while (f->n < FOLDER_MOST && end - at > 4 && strchr("@/|~", at[0]) && at[0] && at[1] == ' ') {
		struct folder_entry *e = &f->entries[f->n];
		const char *line = memchr(at, '\n', (size_t)(end - at)), *gap = line ? memrchr(at + 2, ' ', (size_t)(line - at - 2)) : 0;
		char digits[12] = "";
		if (!gap || line - gap > 10 || !name_is_fine(at + 2, (size_t)(gap - at - 2)))
			return;
		memcpy(digits, gap + 1, (size_t)(line - gap - 1));
		e->kind = at[0];
		memcpy(e->name, at + 2, (size_t)(gap - at - 2));
		e->name[gap - at - 2] = 0;
		e->size = strtoul(digits, 0, 10);
		if (e->size > (size_t)(end - line - 1))
			e->size = (size_t)(end - line - 1);
		e->data = (const uint8_t *)line + 1;
		at = line + 1 + e->size;
		f->n++;
	}
}

size_t folder_pack(uint8_t *out, size_t most, const struct folder *f)
{
	size_t n = 0;
	for (int i = 0; i < f->n; i++) {
		const struct folder_entry *e = &f->entries[i];
		char head[FOLDER_NAME + 32];
		const int h = snprintf(head, sizeof head, "%c %s %zu\n", e->kind, e->name, e->size);
		if (n + (size_t)h + e->size > most)
			return 0;
		memcpy(out + n, head, (size_t)h);
		if (e->size)
			memcpy(out + n + h, e->data, e->size);
		n += (size_t)h + e->size;
	}
	return n;
}

static void make_file(const char *path, const struct folder_entry *e)
{
	const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
	char digits[24] = "";
	memcpy(digits, e->data, e->kind == '~' && e->size < sizeof digits ? e->size : 0);
	if (fd >= 0 && (e->kind == '~' ? ftruncate(fd, (off_t)(strtoull(digits, 0, 10) & ((1ull << 43) - 1))) : write(fd, e->data, e->size) < 0))
		perror("capture");
	if (fd >= 0)
		close(fd);
}

void folder_unpack(const struct folder *f, const char *dir)
{
	for (int i = 0; i < f->n; i++) {
		const struct folder_entry *e = &f->entries[i];
		char path[4096];
		snprintf(path, sizeof path, "%s/%s", dir, e->name);
		for (char *slash = strchr(path + strlen(dir) + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
			*slash = 0;
			mkdir(path, 0755);
			*slash = '/';
		}
		if (e->kind == '/')
			mkdir(path, 0755);
		else if (e->kind == '|')
			mkfifo(path, 0644);
		else
			make_file(path, e);
	}
}

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *ftw)
{
	(void)st;
	(void)kind;
	if (ftw->level)
		remove(path);
	return 0;
}

void folder_empty(const char *dir)
{
	nftw(dir, remove_one, 32, FTW_DEPTH | FTW_PHYS);
}
