/* work: the lock of a capture's folder work/, in which one stage at a time writes, and its temporary files. */
#ifndef BASE_WORK_H
#define BASE_WORK_H
#include "base/err.h"

/* Tries to lock work/, which is made if need be. Returns a file descriptor, whose close() unlocks, or -1, err set.
 * *busy  out: another program holds the lock, and the descriptor is not locked yet: work_wait waits for it */
int work_lock(const char *capture, bool *busy, struct err *err);
void work_wait(int lock);

/* Removes the temporary files (file_temporary) that killed programs left below work/. The lock must be held. A file that another
 * program is writing without the lock is left alone: file_write locks it. */
void work_sweep(const char *capture);

#endif
