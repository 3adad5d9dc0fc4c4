/* scratch: a folder of a test's own, in $TMPDIR or /tmp, removed at the end.
 * In a unit test: SCRATCH_TEST(name) in place of cmocka_unit_test(name) gives that test an empty folder; scratch_setup and
 * scratch_teardown as the group's fixture give one to all tests of the program. Benchmarks call scratch_open and scratch_close.
 */
#ifndef TESTS_SCRATCH_H
#define TESTS_SCRATCH_H
#include <stddef.h>

/* Makes the folder; its path is valid until scratch_close. One at a time in a process. */
const char *scratch_open(void);
/* Removes the folder with all that is in it. */
void scratch_close(void);

/* The same two as a fixture of cmocka. */
int scratch_setup(void **state);
int scratch_teardown(void **state);
#define SCRATCH_TEST(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

/* A further folder, beside the process's one. The caller frees the path, by scratch_folder_remove. */
char *scratch_folder(void);
void scratch_folder_remove(char *folder);

/* Path of a file in it. Valid until the eighth call after this one. */
__attribute__((format(printf, 1, 2)))
const char *scratch_path(const char *fmt, ...);

/* Writes a file in it, folders on the way made; the same path as scratch_path. */
const char *scratch_write(const char *rel, const void *data, size_t size);
const char *scratch_text(const char *rel, const char *text);

#endif
