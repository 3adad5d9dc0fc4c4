/* scratch: a folder of a test's own, in the system's place for such, removed at the end. */
#ifndef TESTS_SCRATCH_H
#define TESTS_SCRATCH_H
#include <stddef.h>

/* Makes the folder; its path is valid until scratch_close. One at a time in a process. */
const char *scratch_open(void);
void scratch_close(void);

/* Path of a file in it. Valid until the eighth call after this one. */
__attribute__((format(printf, 1, 2)))
const char *scratch_path(const char *fmt, ...);

/* Writes a file in it, folders on the way made; the same path as scratch_path. */
const char *scratch_write(const char *rel, const void *data, size_t size);
const char *scratch_text(const char *rel, const char *text);

#endif
