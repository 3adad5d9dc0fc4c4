/* all: the search for all light paths of one problem, on which lightpath.c falls back. */
#ifndef OPTICS_LIGHTPATH_ALL_H
#define OPTICS_LIGHTPATH_ALL_H
#include "optics/lightpath/path.h"

/* As lightpath_all(), of a problem that path_is_sound(). */
int path_search(double K[][3], int max, const struct path *path);

#endif
