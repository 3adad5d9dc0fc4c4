/* faults: a disk that fills up, runs out of inodes or breaks, and a clock that jumps, under programs that know nothing of it (LD_PRELOAD).
 *   FAULTS_BELOW=DIR      files below this folder alone; no link in its name
 *   FAULTS_COUNT=FILE     8 bytes that all processes share: calls so far. What is counted is what the kind may strike
 *   FAULTS_KIND=          full: from call FAULTS_AT on nothing more is written, the first write half; inodes: from then on no file is made;
 *                         eio: that call and the FAULTS_MORE ones behind it fail with EIO, reads and closes, too; none: calls are counted
 *   FAULTS_AT=N           0: the first
 *   FAULTS_CLOCK=SECONDS  the clock stands so far off, and files that are closed bear its dates
 * Struck are calls that reach the C library: those of SQLite, OpenEXR, libstdc++'s streams and the programs' own.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum kind { NONE, FULL, INODES, EIO_ };
enum { WRITES = 1, MAKES = 2, OTHER = 4 };  // what a call does

static char below[PATH_MAX];
static uint64_t *count, at, more;
static enum kind kind;
static long offset;

// ISO C does not convert a pointer to an object into one to a function; POSIX has them alike.
#define REAL(f) (((union { void *object; __typeof__(&f) function; }){ real(#f) }).function)

static void *real(const char *name)
{
	void *f = dlsym(RTLD_NEXT, name);
	if (!f)
		abort();
	return f;
}

__attribute__((constructor)) static void begin(void)
{
	const char *dir = getenv("FAULTS_BELOW"), *file = getenv("FAULTS_COUNT"), *what = getenv("FAULTS_KIND"), *text;
	offset = (text = getenv("FAULTS_CLOCK")) ? atol(text) : 0;
	if (!dir || strlen(dir) >= sizeof below)
		return;
	strcpy(below, dir);
	const int fd = file ? (int)syscall(SYS_openat, AT_FDCWD, file, O_RDWR | O_CLOEXEC) : -1;
	void *shared = fd < 0 ? MAP_FAILED : mmap(0, 8, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	if (fd >= 0)
		syscall(SYS_close, fd);
	if (shared == MAP_FAILED || !what)
		return;
	count = shared;
	at = (text = getenv("FAULTS_AT")) ? strtoull(text, 0, 10) : UINT64_MAX;
	more = (text = getenv("FAULTS_MORE")) ? strtoull(text, 0, 10) : 0;
	kind = !strcmp(what, "full") ? FULL : !strcmp(what, "inodes") ? INODES : !strcmp(what, "eio") ? EIO_ : NONE;
}

static bool is_below(const char *path)
{
	const size_t n = strlen(below);
	return n && !strncmp(path, below, n) && (path[n] == '/' || !path[n]);
}

static bool fd_below(int fd)
{
	char link[40], path[PATH_MAX];
	snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
	const ssize_t n = *below ? syscall(SYS_readlink, link, path, sizeof path - 1) : -1;
	path[n > 0 ? n : 0] = 0;
	return is_below(path);
}

/* A name as it was given, made absolute. */
static bool name_below(int dir, const char *name)
{
	char path[2 * PATH_MAX] = "", link[40];
	if (!*below || strlen(name) >= PATH_MAX)
		return false;
	if (*name != '/') {
		snprintf(link, sizeof link, dir == AT_FDCWD ? "/proc/self/cwd" : "/proc/self/fd/%d", dir);
		const ssize_t n = syscall(SYS_readlink, link, path, PATH_MAX - 1);
		path[n > 0 ? n : 0] = 0;
		strcat(path, "/");
	}
	strcat(path, name);
	return is_below(path);
}

/* Whether this call fails, errno set. *first: it is the one that is struck first. */
static bool strikes(int does, bool *first)
{
	*first = false;
	if (!count || (kind == FULL && !(does & (WRITES | MAKES))) || (kind == INODES && !(does & MAKES)))
		return false;
	const uint64_t n = __atomic_fetch_add(count, 1, __ATOMIC_SEQ_CST);
	if (kind == NONE || n < at || (kind == EIO_ && n > at + more))
		return false;
	*first = n == at;
	errno = kind == EIO_ ? EIO : ENOSPC;
	return true;
}

static bool fails(int does)
{
	bool first;
	return strikes(does, &first);
}

static bool makes(int dir, const char *name, int flags)
{
	return (flags & O_CREAT) && faccessat(dir, name, F_OK, AT_SYMLINK_NOFOLLOW);
}

static bool open_fails(int dir, const char *name, int flags)
{
	const int was = errno;
	if (!name_below(dir, name))
		return false;
	const bool made = makes(dir, name, flags);
	errno = was;
	return fails(made ? MAKES : OTHER);
}

#define OPEN(name_, at_, call_) \
	{ \
		mode_t mode = 0; \
		if (flags & (O_CREAT | __O_TMPFILE)) { \
			va_list ap; \
			va_start(ap, flags); \
			mode = va_arg(ap, mode_t); \
			va_end(ap); \
		} \
		return open_fails(at_, path, flags) ? -1 : REAL(name_) call_; \
	}
int open(const char *path, int flags, ...) OPEN(open, AT_FDCWD, (path, flags, mode))
int open64(const char *path, int flags, ...) OPEN(open64, AT_FDCWD, (path, flags, mode))
int openat(int dir, const char *path, int flags, ...) OPEN(openat, dir, (dir, path, flags, mode))
int openat64(int dir, const char *path, int flags, ...) OPEN(openat64, dir, (dir, path, flags, mode))

static int flags_of(const char *mode)
{
	return strpbrk(mode, "wa") ? O_CREAT : 0;
}

FILE *fopen(const char *path, const char *mode)
{
	return open_fails(AT_FDCWD, path, flags_of(mode)) ? 0 : REAL(fopen)(path, mode);
}

FILE *fopen64(const char *path, const char *mode)
{
	return open_fails(AT_FDCWD, path, flags_of(mode)) ? 0 : REAL(fopen64)(path, mode);
}

/* Writes: the first that is struck puts half of its bytes. */
static bool write_fails(int fd, size_t *size, bool *half)
{
	*half = false;
	if (!fd_below(fd) || !strikes(WRITES, half))
		return false;
	*half = *half && *size > 1;
	*size /= 2;
	return true;
}

#define WRITE(name, params, args) \
	ssize_t name params \
	{ \
		bool half; \
		return write_fails(fd, &size, &half) && !half ? -1 : REAL(name) args; \
	}
WRITE(write, (int fd, const void *data, size_t size), (fd, data, size))
WRITE(pwrite, (int fd, const void *data, size_t size, off_t where), (fd, data, size, where))
WRITE(pwrite64, (int fd, const void *data, size_t size, off64_t where), (fd, data, size, where))

ssize_t writev(int fd, const struct iovec *parts, int n)
{
	return fd_below(fd) && fails(WRITES) ? -1 : REAL(writev)(fd, parts, n);
}

/* Calls on a file that is open, and on names. */
#define ON_FD(type, name, does, params, args) \
	type name params { return fd_below(fd) && fails(does) ? (type)-1 : REAL(name) args; }
ON_FD(ssize_t, read, OTHER, (int fd, void *data, size_t size), (fd, data, size))
ON_FD(ssize_t, pread, OTHER, (int fd, void *data, size_t size, off_t where), (fd, data, size, where))
ON_FD(ssize_t, pread64, OTHER, (int fd, void *data, size_t size, off64_t where), (fd, data, size, where))
ON_FD(int, fsync, WRITES, (int fd), (fd))
ON_FD(int, fdatasync, WRITES, (int fd), (fd))
ON_FD(int, ftruncate, WRITES, (int fd, off_t size), (fd, size))
ON_FD(int, ftruncate64, WRITES, (int fd, off64_t size), (fd, size))

void *mmap(void *where, size_t size, int rights, int flags, int fd, off_t from)
{
	return fd >= 0 && fd_below(fd) && fails(OTHER) ? MAP_FAILED : REAL(mmap)(where, size, rights, flags, fd, from);
}

/* A folder that is there needs no room: mkdir says EEXIST. */
static int folder_there(int dir, const char *path)
{
	return faccessat(dir, path, F_OK, AT_SYMLINK_NOFOLLOW) ? MAKES : OTHER;
}

#define ON_NAME(name, does, params, dir, path, args) \
	int name params { return name_below(dir, path) && fails(does) ? -1 : REAL(name) args; }
ON_NAME(mkdir, folder_there(AT_FDCWD, path), (const char *path, mode_t mode), AT_FDCWD, path, (path, mode))
ON_NAME(mkdirat, folder_there(dir, path), (int dir, const char *path, mode_t mode), dir, path, (dir, path, mode))
ON_NAME(rename, WRITES, (const char *from, const char *to), AT_FDCWD, to, (from, to))
ON_NAME(renameat, WRITES, (int dir, const char *from, int into, const char *to), into, to, (dir, from, into, to))
ON_NAME(unlink, OTHER, (const char *path), AT_FDCWD, path, (path))
ON_NAME(link, MAKES, (const char *from, const char *to), AT_FDCWD, to, (from, to))

/* What a file system that puts off its writing says at the end: the file is closed all the same. Its date is the jumped clock's. */
int close(int fd)
{
	if (!*below || !fd_below(fd))
		return REAL(close)(fd);
	const int was = errno;
	const bool fail = fails(WRITES);
	const int why = errno, mode = (int)syscall(SYS_fcntl, fd, F_GETFL);
	if (offset && mode >= 0 && (mode & O_ACCMODE) != O_RDONLY) {
		struct timespec now;
		syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
		now.tv_sec += offset;
		syscall(SYS_utimensat, fd, 0, (struct timespec[]){ now, now }, 0);
	}
	errno = was;
	const int got = REAL(close)(fd);
	if (fail)
		errno = why;
	return fail ? -1 : got;
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
	const int got = (int)syscall(SYS_clock_gettime, clock, now);
	if (!got && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
		now->tv_sec += offset;
	return got;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone)
{
	struct timespec t;
	(void)zone;
	clock_gettime(CLOCK_REALTIME, &t);
	*now = (struct timeval){ t.tv_sec, t.tv_nsec / 1000 };
	return 0;
}

time_t time(time_t *out)
{
	struct timespec t;
	clock_gettime(CLOCK_REALTIME, &t);
	if (out)
		*out = t.tv_sec;
	return t.tv_sec;
}
