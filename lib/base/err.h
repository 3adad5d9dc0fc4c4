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
	bool usage;  // the command line is at fault, not a file: exit status 2 instead of 1
};

/* Sets the message, unless there is one: place, key, value, rule ("%s: camera count = %d, must be >= 2"). Returns false. */
__attribute__((format(printf, 2, 3)))
bool err_set(struct err *err, const char *fmt, ...);

/* The same for a fault of the command line: sets err->usage, too. Returns false. */
__attribute__((format(printf, 2, 3)))
bool err_usage(struct err *err, const char *fmt, ...);

/* Puts "context: " before the message. Returns false. */
__attribute__((format(printf, 2, 3)))
bool err_wrap(struct err *err, const char *fmt, ...);

/* The message without "place: " at its front, for where the place is said otherwise. Valid as long as err is. */
const char *err_less(const struct err *err, const char *place);

static inline bool err_is(const struct err *err)
{
	return err->msg[0] != 0;
}

#ifdef __cplusplus
}
#endif

#endif
