/* mirror: a capture that is only read, WORK= elsewhere. */
#ifndef PLAN_MIRROR_H
#define PLAN_MIRROR_H
#include "base/err.h"

/* Makes `capture` a folder of links to what `source` holds but for its work/: what is read is read there, what is written is written
 * in capture/work/. Links of entries that are gone are removed; programs accept the links while file_source() names the folder.
 * Returns false, err set, when source is no folder, one lies in the other, or capture holds something else than such links. */
bool plan_mirror(const char *capture, const char *source, struct err *err);

#endif
