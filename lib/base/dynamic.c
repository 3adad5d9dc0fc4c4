#include "base/dynamic.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

void *dynamic_library(const char *soname, char *why, size_t size)
{
	void *library = dlopen(soname, RTLD_LAZY | RTLD_LOCAL);
	const char *said = library ? 0 : dlerror();
	if (!library && !*why)
		snprintf(why, size, "%s", said ? said : soname);
	return library;
}

void dynamic_function(void *to, void *library, const char *name, char *why, size_t size)
{
	// Copied as bytes: ISO C does not convert a pointer to an object into one to a function; POSIX has them alike.
	void *f = library ? dlsym(library, name) : 0;
	if (!f && !*why)
		snprintf(why, size, "no function %s", name);
	memcpy(to, &f, sizeof f);
}
