/* mem: allocation that does not fail: running out of memory ends the program with one line and exit 1. */
#ifndef BASE_MEM_H
#define BASE_MEM_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

/* Allocates n objects of `size` bytes, zeroed; free(). */
void *mem_new(size_t n, size_t size);

/* Allocates n objects of `size` bytes, not zeroed, aligned to 64 bytes for vector loads; free(). */
void *mem_array(size_t n, size_t size);

/* Resizes p (null: allocates) to n objects of `size` bytes; returns the new address; what is added is not zeroed. */
void *mem_grow(void *p, size_t n, size_t size);

/* A copy of a string; free(). */
char *mem_str(const char *s);

/* printf into a new string; free(). */
__attribute__((format(printf, 1, 2)))
char *mem_printf(const char *fmt, ...);

/* First in main, of programs that free large arrays and ask for as large ones at once, over and over: what is freed stays with the program, since the
 * kernel takes as long to make new pages as some of its loops to fill them. Arrays of more than 32 MiB are given back all the same. */
void mem_hold(void);

#ifdef __cplusplus
}
#endif
#endif
