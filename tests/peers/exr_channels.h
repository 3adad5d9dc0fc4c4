/* exr_channels: which channels an EXR file holds. The product asks for channels by their names. */
#ifndef TESTS_EXR_CHANNELS_H
#define TESTS_EXR_CHANNELS_H
#include "base/err.h"

/* names: the names of the first part's channels in the file's order (alphabetical), comma-separated; null on failure; free().
 * False, err set, when the file is no OpenEXR file. */
bool exr_channels(char **names, const char *path, struct err *err);

#endif
