#include "base/blas.h"

#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include "base/mem.h"

/* Of OpenBLAS; null where the program is linked without. */
extern void openblas_set_num_threads(int n) __attribute__((weak));
extern void *blas_memory_alloc(int) __attribute__((weak));
extern void blas_memory_free(void *) __attribute__((weak));

/* Address space of one of its buffers, and what a stage needs beside, bytes. */
static const size_t BUFFER = (size_t)130 << 20, BESIDE = (size_t)256 << 20;

bool blas_prepare(int threads, struct err *err)
{
	struct rlimit space;
	if (!openblas_set_num_threads)
		return true;
	if (getrlimit(RLIMIT_AS, &space) || space.rlim_cur == RLIM_INFINITY || !blas_memory_alloc || !blas_memory_free) {
		openblas_set_num_threads(1);
		return true;
	}
	// One more than the stage's threads: a thread that OpenBLAS has begun by itself asks for its own.
	const size_t n = (size_t)threads + 1, want = n * BUFFER + BESIDE;
	void *room = mmap(0, want, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	if (room == MAP_FAILED)
		return err_set(err, "ulimit -v = %llu KiB of address space: %d threads need %zu KiB more than the program itself; give more, or --threads=1",
		               (unsigned long long)space.rlim_cur >> 10, threads, want >> 10);
	munmap(room, want);
	void **buffers = mem_new(n, sizeof *buffers);
	for (size_t i = 0; i < n; i++)
		buffers[i] = blas_memory_alloc(0);
	for (size_t i = 0; i < n; i++)
		blas_memory_free(buffers[i]);
	free(buffers);
	openblas_set_num_threads(1);
	return true;
}
