/* bulk: arrays that grow with the length of a film, in constant memory: they lie in files without names on the capture's disk and are mapped; a thread takes pages out of
 * memory as soon as too many are in it, which the system reads again when they are touched. They are used as any array.
 * Where the disk gives no room an array lies in memory. A null bulk is memory, too.
 */
#ifndef BASE_BULK_H
#define BASE_BULK_H
#include <stddef.h>

struct bulk;

/* dir: a folder that is written to, made where it is missing. resident: bytes that may stay in memory, about. bulk_close, after bulk_free of all arrays. */
struct bulk *bulk_open(const char *dir, size_t resident);
void bulk_close(struct bulk *bulk);

/* As mem_grow: resizes p (null: allocates) to n objects of `size` bytes; it never shrinks. What is added is zero where p lies on the disk, else anything. */
void *bulk_grow(struct bulk *bulk, void *p, size_t n, size_t size);

/* As mem_new: n objects, zeroed. */
void *bulk_new(struct bulk *bulk, size_t n, size_t size);

/* As free(). */
void bulk_free(struct bulk *bulk, void *p);

#endif
