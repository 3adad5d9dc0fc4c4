/* gate_walk: what stands below a folder, level by level from the gate (gate.h): no link is followed. */
#ifndef BASE_GATE_WALK_H
#define BASE_GATE_WALK_H
#include <stdbool.h>

/* Removes a folder that is empty. False, errno set. */
bool gate_rmdir(const char *dir);

/* Of one name in the folder `folder`. Returns false, errno set, where what it does to it fails. */
typedef bool gate_visit(void *ctx, int folder, const char *name, bool is_folder);

/* Visits all that stands below a folder, what is in a folder before that folder itself, links as what they are. Goes on where something
 * fails, and then returns false, errno set by the first of these. */
bool gate_walk(const char *dir, gate_visit *visit, void *ctx);

#endif
