#include "base/err.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* One line, whatever a file that is quoted in it holds. */
static void plain(struct err *err)
{
	for (char *c = err->msg; *c; c++)
		*c = (unsigned char)*c < ' ' || *c == 127 ? ' ' : *c;
}

bool err_set(struct err *err, const char *fmt, ...)
{
	if (err_is(err))
		return false;
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(err->msg, sizeof err->msg, fmt, ap);
	va_end(ap);
	plain(err);
	return false;
}

bool err_usage(struct err *err, const char *fmt, ...)
{
	if (err_is(err))
		return false;
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(err->msg, sizeof err->msg, fmt, ap);
	va_end(ap);
	plain(err);
	err->usage = true;
	return false;
}

bool err_wrap(struct err *err, const char *fmt, ...)
{
	char old[sizeof err->msg], context[sizeof err->msg];
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(context, sizeof context, fmt, ap);
	va_end(ap);
	memcpy(old, err->msg, sizeof old);
	if (snprintf(err->msg, sizeof err->msg, "%.400s: %s", context, old) < 0)
		err->msg[0] = '?';
	plain(err);
	return false;
}

const char *err_less(const struct err *err, const char *place)
{
	size_t n = strlen(place);
	const char *msg = err->msg;
	if (!strncmp(msg, place, n))
		msg += n + (msg[n] == ':');
	return msg + strspn(msg, " ");
}
