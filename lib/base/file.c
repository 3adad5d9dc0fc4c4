#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/asked.h"
#include "base/gate.h"
#include "base/mem.h"

/* Opens a regular file for reading. A pipe or device is refused: it could block or never end. */
static int open_regular(const char *path, struct stat *st, struct err *err)
{
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0) {
		asked_in_vain(path, errno);
		err_set(err, "%s: %s", path, strerror(errno));
		return -1;
	}
	if (fstat(fd, st) || !S_ISREG(st->st_mode)) {
		err_set(err, "%s: %s", path, S_ISDIR(st->st_mode) ? "is a folder, must be a file" : "is not a regular file");
		close(fd);
		return -1;
	}
	return fd;
}

bool file_opens(const char *path, uint64_t limit, struct err *err)
{
	struct stat st;
	if (stat(path, &st))
		return true;
	return (S_ISREG(st.st_mode) || err_set(err, "%s: %s", path, S_ISDIR(st.st_mode) ? "is a folder, must be a file" : "is not a regular file"))
	       && ((uint64_t)st.st_size <= limit || err_set(err, "%s: %lld bytes, must be <= %llu", path, (long long)st.st_size, (unsigned long long)limit));
}

bool file_read(char **data, size_t *size, const char *path, size_t limit, struct err *err)
{
	struct stat st;
	*data = 0;
	*size = 0;
	int fd = open_regular(path, &st, err);
	if (fd < 0)
		return false;
	if ((size_t)st.st_size > limit) {
		close(fd);
		return err_set(err, "%s: %lld bytes, must be <= %zu", path, (long long)st.st_size, limit);
	}
	size_t have = 0, want = (size_t)st.st_size;
	char *buf = mem_array(want + 1, 1);
	while (have < want) {
		ssize_t got = read(fd, buf + have, want - have);
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			asked_in_vain(path, errno);
		if (got <= 0)
			break;
		have += (size_t)got;
	}
	close(fd);
	if (have < want) {
		free(buf);
		return err_set(err, "%s: ends after %zu of %zu bytes", path, have, want);
	}
	buf[have] = 0;
	*data = buf;
	*size = have;
	return true;
}

/* Why something cannot be written: a link in a folder's place is told of as one. */
static const char *why_not(int why)
{
	return why == ELOOP || why == EXDEV ? "a link stands in a folder's or a file's place: only work/ itself is written" : strerror(why);
}

bool file_mkdirs(const char *dir, struct err *err)
{
	const int fd = gate_folder(dir, true), why = errno;
	if (fd >= 0)
		close(fd);
	return fd >= 0 || err_set(err, "%s: %s", dir, why == ENOTDIR || why == EEXIST ? "is not a folder" : why_not(why));
}

char *file_temporary(const char *path)
{
	const char *slash = strrchr(path, '/');
	char hash[33];
	file_hash_bytes(hash, path, strlen(path));
	hash[16] = 0;
	return mem_printf("%.*s.%s.new", slash ? (int)(slash - path + 1) : 0, path, hash);
}

bool file_is_temporary(const char *name)
{
	return name[0] == '.' && strspn(name + 1, "0123456789abcdef") == 16 && !strcmp(name + 17, ".new");
}

static bool write_all(int fd, const char *data, size_t size)
{
	while (size) {
		ssize_t put = write(fd, data, size);
		if (put < 0 && errno == EINTR)
			continue;
		if (put <= 0)
			return false;
		data += put;
		size -= (size_t)put;
	}
	return true;
}

/* Opens the temporary file, empty and locked. Another program that writes the same file waits for the lock, finds that the file
 * has been renamed meanwhile, and tries again. */
static int open_alone(int folder, const char *tmp)
{
	for (;;) {
		struct stat is, named;
		int fd = openat(folder, tmp, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
		if (fd < 0)
			return fd;
		while (flock(fd, LOCK_EX) && errno == EINTR)
			;
		if (!fstat(fd, &is) && !fstatat(folder, tmp, &named, AT_SYMLINK_NOFOLLOW) && is.st_ino == named.st_ino && is.st_dev == named.st_dev) {
			if (!ftruncate(fd, 0))
				return fd;
			int why = errno;
			close(fd);
			errno = why;
			return -1;
		}
		close(fd);
	}
}

/* Flushes, so that write errors that the file system has deferred appear now; the file stays open and locked. */
static bool flushed(int fd)
{
	int same = dup(fd);
	return same >= 0 && !close(same);
}

static bool write_parts(int fd, int n, const struct file_part part[])
{
	bool ok = true;
	for (int i = 0; i < n && ok; i++)
		ok = write_all(fd, part[i].data, part[i].size);
	return ok;
}

bool file_write(const char *path, const void *data, size_t size, struct err *err)
{
	return file_write_parts(path, 1, &(const struct file_part){ data, size }, err);
}

bool file_write_parts(const char *path, int n, const struct file_part part[], struct err *err)
{
	const char *name;
	const int folder = gate_parent(&name, path, true);
	if (folder < 0)
		return err_set(err, "%s: cannot write: %s", path, why_not(errno));
	char *beside = file_temporary(path), *slash = strrchr(beside, '/'), *tmp = slash ? slash + 1 : beside;
	int fd = open_alone(folder, tmp);
	bool ok = fd >= 0 && write_parts(fd, n, part) && flushed(fd) && !renameat(folder, tmp, folder, name);
	int why = errno;
	if (!ok && fd >= 0)
		unlinkat(folder, tmp, 0);
	if (fd >= 0)
		close(fd);
	close(folder);
	if (!ok)
		err_set(err, "%s: cannot write: %s", path, why_not(why));
	free(beside);
	return ok;
}

bool file_exists(const char *path)
{
	struct stat st;
	const bool there = !stat(path, &st);
	if (!there)
		asked_in_vain(path, errno);
	return there;
}

bool file_remove(const char *path, struct err *err)
{
	const char *name;
	const int folder = gate_parent(&name, path, false);
	const bool ok = folder >= 0 ? !unlinkat(folder, name, 0) || errno == ENOENT : errno == ENOENT;
	if (!ok)
		err_set(err, "%s: cannot remove: %s", path, why_not(errno));
	if (folder >= 0)
		close(folder);
	return ok;
}

static void hash_text(char out[33], XXH128_hash_t h)
{
	snprintf(out, 33, "%016llx%016llx", (unsigned long long)h.high64, (unsigned long long)h.low64);
}

void file_hash_bytes(char out[33], const void *data, size_t size)
{
	hash_text(out, XXH3_128bits(data, size));
}

bool file_hash(char out[33], const char *path, uint64_t limit, struct err *err)
{
	struct stat st;
	int fd = open_regular(path, &st, err);
	if (fd < 0)
		return false;
	if ((uint64_t)st.st_size > limit) {
		close(fd);
		return err_set(err, "%s: %lld bytes, must be <= %llu", path, (long long)st.st_size, (unsigned long long)limit);
	}
	enum { PIECE = 1 << 18 };
	XXH3_state_t *state = XXH3_createState();
	char *buf = mem_array(PIECE, 1);
	XXH3_128bits_reset(state);
	ssize_t got;
	while ((got = read(fd, buf, PIECE)) > 0)
		XXH3_128bits_update(state, buf, (size_t)got);
	const int why = errno;
	hash_text(out, XXH3_128bits_digest(state));
	XXH3_freeState(state);
	free(buf);
	close(fd);
	if (got < 0)
		asked_in_vain(path, why);
	return got == 0 ? true : err_set(err, "%s: cannot read: %s", path, strerror(why));
}

static int by_bytes(const void *a, const void *b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

bool file_list(struct file_list *out, const char *dir, struct err *err)
{
	*out = (struct file_list){ 0 };
	DIR *d = opendir(dir);
	if (!d) {
		const int why = errno;
		asked_in_vain(dir, why);
		return why == ENOENT ? true : err_set(err, "%s: %s", dir, strerror(why));
	}
	struct dirent *e;
	while ((e = readdir(d))) {
		if (e->d_name[0] == '.')
			continue;
		out->names = mem_grow(out->names, (size_t)out->n + 1, sizeof *out->names);
		out->names[out->n++] = mem_str(e->d_name);
	}
	closedir(d);
	if (out->n)
		qsort(out->names, (size_t)out->n, sizeof *out->names, by_bytes);
	return true;
}

void file_list_free(struct file_list *list)
{
	for (int i = 0; i < list->n; i++)
		free(list->names[i]);
	free(list->names);
	*list = (struct file_list){ 0 };
}

bool file_is_relative(const char *rel)
{
	if (!*rel || *rel == '/')
		return false;
	for (const char *p = rel; p; p = strchr(p, '/')) {
		p += *p == '/';
		if (p[0] == '.' && p[1] == '.' && (!p[2] || p[2] == '/'))
			return false;
	}
	return true;
}

const char *file_source(void)
{
	const char *source = getenv("EYEWRIGHT_SOURCE");
	return source && *source ? source : 0;
}

static bool is_below(const char *real, const char *folder)
{
	const size_t n = strlen(folder);
	return !strncmp(real, folder, n) && (real[n] == '/' || !real[n] || n == 1);
}

bool file_leads_inside(const char *real, const char *root)
{
	char *source = file_source() ? realpath(file_source(), 0) : 0;
	const bool inside = is_below(real, root) || (source && is_below(real, source));
	free(source);
	return inside;
}

bool file_inside(char **out, const char *root, const char *rel, struct err *err)
{
	*out = 0;
	if (!file_is_relative(rel))
		return err_set(err, "%s: leads out of the capture folder", rel);
	char *joined = mem_printf("%s/%s", root, rel);
	char *real_root = realpath(root, 0), *real = realpath(joined, 0);
	bool inside = real && real_root && file_leads_inside(real, real_root);
	if (!real)
		err_set(err, "%s: %s", joined, strerror(errno));
	else if (!inside)
		err_set(err, "%s: leads out of the capture folder", rel);
	free(joined);
	free(real_root);
	if (!inside) {
		free(real);
		return false;
	}
	*out = real;
	return true;
}
