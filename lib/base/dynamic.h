/* dynamic: shared libraries that are loaded when they are first needed. A program that reads no video, no HEIC and no raw photograph
 * does not spend its time on finding and relocating the many libraries that these bring with them.
 */
#ifndef BASE_DYNAMIC_H
#define BASE_DYNAMIC_H
#include <stdbool.h>
#include <stddef.h>

#define DYNAMIC_TEXT_OF(x) #x
#define DYNAMIC_TEXT(x) DYNAMIC_TEXT_OF(x)
/* File name of version `major` of a library: DYNAMIC_SONAME("avformat", 59) is "libavformat.so.59". */
#define DYNAMIC_SONAME(name, major) "lib" name ".so." DYNAMIC_TEXT(major)

/* The library of that file name; it stays loaded. Null where it cannot be loaded: why[size], unless something stands there already,
 * then says why. */
void *dynamic_library(const char *soname, char *why, size_t size);

/* Stores the address of the library's function `name` in *to, a pointer to a function; null, and why[size] as above, where there is
 * none, or where library is null. */
void dynamic_function(void *to, void *library, const char *name, char *why, size_t size);

#endif
