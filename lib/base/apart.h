/* apart: a function that reads strangers' bytes runs in a process of its own, which can read one folder, write nothing but its result,
 * and dies alone.
 */
#ifndef BASE_APART_H
#define BASE_APART_H
#include <stddef.h>

#include "base/err.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The result of the function, as it grows. */
struct apart_out;
/* Appends bytes. False when the result is larger than its limit: the function may stop then. */
bool apart_put(struct apart_out *out, const void *bytes, size_t size);

struct apart {
	bool (*run)(void *ctx, struct apart_out *out, struct err *err);  // false, err set: the data cannot be used
	void *ctx;
	const char *reads;   // the one folder whose files it may open for reading; null: none
	size_t memory;       // bytes that it may take beyond what this process has
	size_t result;       // most bytes of its result
	double seconds;      // of processor time; it is ended, too, when it all but stands still for so long by the clock
};

/* Runs it to its end.
 * data, size  out: what it has put, with a zero byte behind it; not to be trusted. free()
 * Returns false, err set (one line), when it says so, needs more than the limits, or dies, of whatever signal. */
bool apart_run(char **data, size_t *size, const struct apart *apart, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
