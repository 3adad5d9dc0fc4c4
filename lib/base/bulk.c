#include "base/bulk.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/gate.h"
#include "base/mem.h"

struct array {
	void *at;
	size_t bytes;          // of its mapping
	int fd;
};

struct bulk {
	char *dir;
	size_t resident, others;  // bytes; of files that the process had mapped before
	int n, made;           // arrays now; files made so far
	struct array *array;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	pthread_t thread;
	bool threaded, ending;
};

/* Bytes of files, libraries among them, that are mapped and in memory. */
static size_t mapped_in_memory(void)
{
	unsigned long all = 0, resident = 0, shared = 0;
	FILE *f = fopen("/proc/self/statm", "r");
	if (f && fscanf(f, "%lu %lu %lu", &all, &resident, &shared) != 3)
		shared = 0;
	if (f)
		fclose(f);
	return shared * (size_t)sysconf(_SC_PAGESIZE);
}

/* Takes all pages out of memory, twenty milliseconds after too many are in it at the latest. The mapping is shared: what was written stays with the file. */
static void *keep_small(void *data)
{
	const long look_ns = 20000000;
	struct bulk *b = data;
	pthread_mutex_lock(&b->lock);
	while (!b->ending) {
		struct timespec t;
		clock_gettime(CLOCK_REALTIME, &t);
		t.tv_nsec += look_ns;
		t.tv_sec += t.tv_nsec / 1000000000;
		t.tv_nsec %= 1000000000;
		pthread_cond_timedwait(&b->changed, &b->lock, &t);
		size_t all = 0;
		for (int i = 0; i < b->n; i++)
			all += b->array[i].bytes;
		for (int i = 0; i < b->n && all > b->resident && mapped_in_memory() > b->others + b->resident; i++)
			madvise(b->array[i].at, b->array[i].bytes, MADV_DONTNEED);
	}
	pthread_mutex_unlock(&b->lock);
	return 0;
}

struct bulk *bulk_open(const char *dir, size_t resident)
{
	struct bulk *b = mem_new(1, sizeof *b);
	b->dir = mem_str(dir);
	b->resident = resident;
	b->others = mapped_in_memory();
	pthread_mutex_init(&b->lock, 0);
	pthread_cond_init(&b->changed, 0);
	b->threaded = pthread_create(&b->thread, 0, keep_small, b) == 0;
	return b;
}

static void drop(struct bulk *b, int i)
{
	munmap(b->array[i].at, b->array[i].bytes);
	close(b->array[i].fd);
	b->array[i] = b->array[--b->n];
}

void bulk_close(struct bulk *b)
{
	if (!b)
		return;
	if (b->threaded) {
		pthread_mutex_lock(&b->lock);
		b->ending = true;
		pthread_cond_broadcast(&b->changed);
		pthread_mutex_unlock(&b->lock);
		pthread_join(b->thread, 0);
	}
	while (b->n)
		drop(b, 0);
	pthread_mutex_destroy(&b->lock);
	pthread_cond_destroy(&b->changed);
	free(b->array);
	free(b->dir);
	free(b);
}

/* A file without a name: one that is killed leaves nothing. -1 where there can be none. */
static int nameless(struct bulk *b)
{
	struct err none = { 0 };
	char *path = mem_printf("%s/bulk%d", b->dir, b->made++), *name = file_temporary(path);
	const int fd = gate_create(name, O_RDWR | O_TRUNC | O_NOFOLLOW);
	if (fd >= 0)
		file_remove(name, &none);
	free(path);
	free(name);
	return fd;
}

static int find(const struct bulk *b, const void *p)
{
	int i = 0;
	while (i < b->n && b->array[i].at != p)
		i++;
	return p && i < b->n ? i : -1;
}

/* Null where the disk has no room. */
static void *first(struct bulk *b, size_t bytes)
{
	const int fd = nameless(b);
	void *at = fd >= 0 && !posix_fallocate(fd, 0, (off_t)bytes) ? mmap(0, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) : MAP_FAILED;
	if (at == MAP_FAILED) {
		if (fd >= 0)
			close(fd);
		return 0;
	}
	b->array = mem_grow(b->array, (size_t)b->n + 1, sizeof *b->array);
	b->array[b->n++] = (struct array){ at, bytes, fd };
	return at;
}

static void *more(struct bulk *b, int i, size_t bytes)
{
	struct array *a = &b->array[i];
	if (bytes <= a->bytes)
		return a->at;
	void *at = posix_fallocate(a->fd, 0, (off_t)bytes) ? MAP_FAILED : mremap(a->at, a->bytes, bytes, MREMAP_MAYMOVE);
	if (at != MAP_FAILED) {
		a->at = at;
		a->bytes = bytes;
		return at;
	}
	at = mem_array(bytes, 1);
	memcpy(at, a->at, a->bytes);
	drop(b, i);
	return at;
}

void *bulk_grow(struct bulk *b, void *p, size_t n, size_t size)
{
	const size_t page = (size_t)sysconf(_SC_PAGESIZE);
	if (!b || n > (SIZE_MAX - page) / size)
		return mem_grow(p, n, size);
	const size_t bytes = n > 0 && size > 0 ? (n * size + page - 1) / page * page : page;
	pthread_mutex_lock(&b->lock);
	const int i = find(b, p);
	void *at = i >= 0 ? more(b, i, bytes) : p ? 0 : first(b, bytes);
	pthread_mutex_unlock(&b->lock);
	return at ? at : mem_grow(p, n, size);
}

void *bulk_new(struct bulk *b, size_t n, size_t size)
{
	void *p = bulk_grow(b, 0, n, size);
	memset(p, 0, n * size);
	return p;
}

void bulk_free(struct bulk *b, void *p)
{
	int i = -1;
	if (b) {
		pthread_mutex_lock(&b->lock);
		i = find(b, p);
		if (i >= 0)
			drop(b, i);
		pthread_mutex_unlock(&b->lock);
	}
	if (i < 0)
		free(p);
}
