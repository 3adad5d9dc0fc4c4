/* keys: the stage's table of options, copied as it is resolved, and values at its limits. */
#ifndef TESTS_FUZZ_CAPTURE_KEYS_H
#define TESTS_FUZZ_CAPTURE_KEYS_H
#include <stddef.h>
#include <stdint.h>

#include "base/opt.h"

/* Copies the table; the first call counts. */
void keys_take(const char *stage, int n, const struct opt opts[]);

/* Writes "key = value", the key one of the table's, the value often at a limit. names[n]: what a star may stand for.
 * Returns its length, 0 without a table. */
size_t keys_line(char *out, size_t most, int n, const char *const names[], uint64_t *seed);

/* A number as text, often one that programs forget. */
void keys_number(char *out, size_t most, uint64_t *seed);

/* The next random number of the seed. */
uint64_t keys_random(uint64_t *seed);

#endif
