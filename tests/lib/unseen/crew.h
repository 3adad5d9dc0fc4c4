/* crew: many independent cases over processes, as libraries and generators of one case need not be safe for threads. */
#ifndef TESTS_UNSEEN_CREW_H
#define TESTS_UNSEEN_CREW_H
#include <stddef.h>

/* n zeroed elements that processes of the crew share. Never freed. */
void *crew_array(size_t n, size_t size);

/* one(ctx, i) for i in 0 .. n - 1, as many processes as processors, one thread each. What it is to keep goes into crew_arrays.
 * A process that dies ends the program: exit status 1. */
void crew_run(int n, void (*one)(void *ctx, int i), void *ctx);

#endif
