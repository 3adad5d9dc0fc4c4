/* unit: cmocka with the headers that it needs, and two checks of our own. */
#ifndef TESTS_UNIT_H
#define TESTS_UNIT_H
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* A test of many cases runs a few of them where this is 1, at a tenth of the speed: memory faults show as well, and the plain run counts. */
#ifdef __SANITIZE_ADDRESS__
enum { SANITISED = 1 };
#else
enum { SANITISED = 0 };
#endif

/* The error's message contains that text. */
#define ERR_HAS(err, text) \
	do { \
		if (!strstr((err).msg, text)) \
			fail_msg("error \"%s\" does not say \"%s\"", (err).msg, text); \
	} while (0)

/* |got - want| <= tolerance; NaN fails. */
#define NEAR(got, want, tolerance) \
	do { \
		double got_ = (double)(got), want_ = (double)(want); \
		if (!(fabs(got_ - want_) <= (double)(tolerance))) \
			fail_msg("%s = %.17g, must be within %g of %.17g", #got, got_, (double)(tolerance), want_); \
	} while (0)

#endif
