/* work: the folder work/ of a capture, which one stage at a time writes in. */
#ifndef BASE_WORK_H
#define BASE_WORK_H
#include "base/err.h"

/* The lock of work/ (made if need be): a file descriptor whose close() gives it back, -1 with err set when it cannot be had.
 * *busy: another program has it, and the descriptor is not locked; work_wait then waits for it. */
int work_lock(const char *capture, bool *busy, struct err *err);
void work_wait(int lock);

/* Removes what killed programs left half written below work/ (file_temporary). The lock must be held: whoever has it writes
 * under such names. What another program is writing without the lock (file_write holds its file) is left alone. */
void work_sweep(const char *capture);

#endif
