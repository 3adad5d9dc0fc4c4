/* record_left: what a record says of files that a run does not ask for any more: of inputs that are gone, or not wanted. They are put aside (aside.h).
 */
#ifndef BASE_RECORD_LEFT_H
#define BASE_RECORD_LEFT_H
#include "base/record.h"

/* Puts aside what earlier runs have made below `dir` ("work", "work/render"), and this one has neither made nor found to hold. To be called when
 * all that is wanted there has been made. */
bool record_put_aside(struct record *record, const char *dir, struct err *err);

/* The rest is for record.c. Objects of a record that name files in their places: path -> how it was made. */
enum { RECORD_KINDS = 2 };
extern const char *const record_kinds[RECORD_KINDS];

/* The path that a key of these stands for: a name that is not UTF-8 is escaped there. free() */
char *record_path_of(const char *key);

/* Whether program and configuration are those of the last run. */
bool record_same_maker(const struct record *record);

/* Keeps what earlier runs have left that this one has not asked for yet, for the next, should this one end here. */
void record_note_left(struct record *record);

/* What has been made counts as left, not as made. */
void record_distrust(struct record *record);

/* Of a run that is complete: forgets what was left, and removes what lies aside of files that it has made anew. */
bool record_settle(struct record *record, struct err *err);

#endif
