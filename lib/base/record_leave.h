/* record_leave: a stage that a capture has no inputs for any more leaves it, with all that it has made (aside.h), and comes back when it is needed.
 * To be called with work/ locked (work.h). False, err set, where a file cannot be moved.
 */
#ifndef BASE_RECORD_LEAVE_H
#define BASE_RECORD_LEAVE_H
#include "base/err.h"

/* Puts aside all that the stage has made, its log and its record. Does nothing where there is no record. */
bool record_leave(const char *capture, const char *stage, struct err *err);

/* Brings that back, where no newer record stands in its place. */
bool record_return(const char *capture, const char *stage, struct err *err);

#endif
