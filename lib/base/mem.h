/* mem: allocation that does not fail. Out of memory ends the program with exit 1 and one line. */
#ifndef BASE_MEM_H
#define BASE_MEM_H
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

/* n objects of `size` bytes, zeroed. Owned by the caller; free(). */
void *mem_new(size_t n, size_t size);

/* n objects of `size` bytes, not zeroed, aligned to 64 bytes for vector loads; free(). */
void *mem_array(size_t n, size_t size);

/* p grown or shrunk to n objects of `size` bytes. */
void *mem_grow(void *p, size_t n, size_t size);

char *mem_str(const char *s);

/* printf into a new string; free(). */
__attribute__((format(printf, 1, 2)))
char *mem_printf(const char *fmt, ...);

#ifdef __cplusplus
}
#endif
#endif
