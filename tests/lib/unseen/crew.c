#include "tests/lib/unseen/crew.h"

#include <omp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

void *crew_array(size_t n, size_t size)
{
	void *p = mmap(0, n * size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (p == MAP_FAILED) {
		perror("mmap");
		exit(1);
	}
	return p;
}

void crew_run(int n, void (*one)(void *ctx, int i), void *ctx)
{
	int *next = crew_array(1, sizeof *next), status;
	const long hands = sysconf(_SC_NPROCESSORS_ONLN);
	bool died = false;
	fflush(0);
	for (long k = 0; k < hands; k++)
		if (fork() == 0) {
			omp_set_num_threads(1);
			for (int i; (i = __atomic_fetch_add(next, 1, __ATOMIC_RELAXED)) < n;)
				one(ctx, i);
			fflush(0);
			_exit(0);
		}
	while (wait(&status) > 0)
		died = died || status;
	munmap(next, sizeof *next);
	if (died) {
		fprintf(stderr, "a process of the crew died\n");
		exit(1);
	}
}
