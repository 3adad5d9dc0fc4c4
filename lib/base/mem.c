#include "base/mem.h"

#include <malloc.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void *or_die(void *p)
{
	if (!p) {
		fputs("out of memory\n", stderr);
		_exit(1);  // exit handlers of libraries wait for threads, which may wait for memory
	}
	return p;
}

void *mem_new(size_t n, size_t size)
{
	return or_die(calloc(n ? n : 1, size ? size : 1));
}

void *mem_array(size_t n, size_t size)
{
	size_t bytes = 0;
	if (__builtin_mul_overflow(n, size, &bytes) || bytes > SIZE_MAX - 64)
		return or_die(0);
	return or_die(aligned_alloc(64, (bytes + 64) & ~(size_t)63));
}

void *mem_grow(void *p, size_t n, size_t size)
{
	return or_die(reallocarray(p, n ? n : 1, size ? size : 1));
}

char *mem_str(const char *s)
{
	return or_die(strdup(s));
}

char *mem_printf(const char *fmt, ...)
{
	va_list ap;
	char *s = 0;
	va_start(ap, fmt);
	if (vasprintf(&s, fmt, ap) < 0)
		s = 0;
	va_end(ap);
	return or_die(s);
}

void mem_hold(void)
{
	mallopt(M_MMAP_THRESHOLD, 32 << 20);
	mallopt(M_TRIM_THRESHOLD, 256 << 20);
	mallopt(M_TOP_PAD, 16 << 20);
}
