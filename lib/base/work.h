/* work: the lock of a capture's folder work/, in which one stage at a time writes, and its temporary files. */
#ifndef BASE_WORK_H
#define BASE_WORK_H
#include "base/err.h"

/* Checks that what is read of the capture lies in it: capture.conf, subject.ply, .obj and the files of photos/, views/, video/, targets/,
 * script/ may be links to files of the capture, not to others. A link that leads nowhere is told of by who reads it. False, err set
 * (path, rule), where one leads out. */
bool work_check_inputs(const char *capture, struct err *err);

/* Checks that no folder of work/, nor work/ itself, is a link, and that no link in it leads out of the capture: files elsewhere would
 * be overwritten or read. False, err set (path, rule), where one does. */
bool work_check(const char *capture, struct err *err);

/* Checks work/ (work_check), makes it if need be, and sets it as the gate (gate.h) of all that this process writes there. False, err set,
 * where it must not be written. */
bool work_enter(const char *capture, struct err *err);

/* Tries to lock work/, which is entered first (work_enter). Returns a file descriptor, whose close() unlocks, or -1, err set.
 * *busy  out: another program holds the lock, and the descriptor is not locked yet: work_wait waits for it */
int work_lock(const char *capture, bool *busy, struct err *err);
void work_wait(int lock);

/* Removes the temporary files (file_temporary) that killed programs left below work/. The lock must be held. A file that another
 * program is writing without the lock is left alone: file_write locks it. */
void work_sweep(const char *capture);

#endif
