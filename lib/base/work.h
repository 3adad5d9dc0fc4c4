/* work: the lock of a capture's folder work/, in which one stage at a time writes, and its temporary files. */
#ifndef BASE_WORK_H
#define BASE_WORK_H
#include "base/err.h"

/* Checks that no folder of work/, nor work/ itself, is a link: files elsewhere would be overwritten. Links to files do no harm: a new
 * file takes their place. False, err set (path, rule), where one is. */
bool work_check(const char *capture, struct err *err);

/* Tries to lock work/, which is made if need be. Returns a file descriptor, whose close() unlocks, or -1, err set.
 * Checks it first (work_check).
 * *busy  out: another program holds the lock, and the descriptor is not locked yet: work_wait waits for it */
int work_lock(const char *capture, bool *busy, struct err *err);
void work_wait(int lock);

/* Removes the temporary files (file_temporary) that killed programs left below work/. The lock must be held. A file that another
 * program is writing without the lock is left alone: file_write locks it. */
void work_sweep(const char *capture);

#endif
