/* gate: the way out. What is written below the gate's folder is opened from that folder's descriptor, and no link is followed at any
 * level: not one that came with the folder, not one that is put there meanwhile. Other paths are opened as they are.
 */
#ifndef BASE_GATE_H
#define BASE_GATE_H
#include <sys/types.h>

#include "base/err.h"

/* Sets the gate's folder, which is there and no link, for this process, once, before its threads begin. Returns false, err set, where
 * it cannot be opened. */
bool gate_set(const char *folder, struct err *err);

/* A descriptor of the folder `dir`, with those above it where they are missing and `make`; close(). -1, errno set: ELOOP or ENOTDIR for
 * a link or a file in a folder's place. */
int gate_folder(const char *dir, bool make);

/* A descriptor of the folder that `path` stands in, as gate_folder. name: out, its last part, within `path`. */
int gate_parent(const char **name, const char *path, bool make);

/* Opens a file for writing, with O_CREAT, O_CLOEXEC and these flags, folders made as need be. -1, errno set; ELOOP: it is a link. */
int gate_create(const char *path, int flags);

/* Renames a file within its folder. False, errno set. */
bool gate_rename(const char *from, const char *to);

#endif
