/* err: what went wrong, in one line.
 * Faults of the input return false through struct err; our own bugs are asserts.
 * A zeroed struct err holds no error. The first error stays: later ones are dropped.
 */
#ifndef BASE_ERR_H
#define BASE_ERR_H
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

struct err {
	char msg[1024];
};

/* Say place, key, value, rule: "%s: camera count = %d, must be >= 2". Always false. */
__attribute__((format(printf, 2, 3)))
bool err_set(struct err *err, const char *fmt, ...);

/* Put "context: " before the message. Always false. */
__attribute__((format(printf, 2, 3)))
bool err_wrap(struct err *err, const char *fmt, ...);

static inline bool err_is(const struct err *err)
{
	return err->msg[0] != 0;
}

#ifdef __cplusplus
}
#endif

#endif
