/* peer: other programs' methods run beside ours by a script in Python, where their package is installed; benchmarks alone use them.
 * A script writes one line a method, the seconds of each run, and leaves what it found as arrays.
 */
#ifndef TESTS_PEER_H
#define TESTS_PEER_H
#include <stdbool.h>
#include <stdio.h>

#include "tests/lib/bench/bench.h"

/* Whether Python has that module; where not, a line says what is left out and how to install it. */
bool peer_installed(const char *bench, const char *module, const char *package);

/* The next line's seconds; NAN where the method failed. */
struct bench_time peer_times(FILE *from);

/* An array of n numbers from that file; null where there is none or it has another size. free(). */
double *peer_array(const char *path, long n);

#endif
