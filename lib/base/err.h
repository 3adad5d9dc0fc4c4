/* err: an error message of one line, filled by the function that fails.
 * A function that meets a fault of the input sets err and returns false (or null); our own bugs are asserts.
 * A zeroed struct err holds no error. The first error is kept; later ones are dropped.
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

/* Sets the message, unless there is one: place, key, value, rule ("%s: camera count = %d, must be >= 2"). Returns false. */
__attribute__((format(printf, 2, 3)))
bool err_set(struct err *err, const char *fmt, ...);

/* Puts "context: " before the message. Returns false. */
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
