/* aside: what an earlier run made and the capture as it is now has no use for. It lies in work/.made/aside/, where no stage and no other
 * program looks, under the path that it had below work/, until its inputs are back: then it is there again without any work.
 */
#ifndef BASE_ASIDE_H
#define BASE_ASIDE_H
#include "base/err.h"

/* Where a file ("work/skin/animation.csv") lies once it has been put aside, relative to the capture too. free() */
char *aside_of(const char *rel);

/* Moves a regular file of the capture there, over one that lies there, and removes folders that it leaves empty. One that is missing, or
 * stands elsewhere than below work/ (a record may come with a stranger's capture), is no error and stays. False, err set, where it cannot be moved. */
bool aside_put(const char *capture, const char *rel, struct err *err);

/* Moves it back, unless something stands in its place. Returns whether it has. */
bool aside_take(const char *capture, const char *rel);

/* Removes what lies there under that path; nothing is no error. */
bool aside_drop(const char *capture, const char *rel, struct err *err);

/* Whether a stage's record (record.h) stands in its place, or (away) lies aside. */
bool aside_stands(const char *capture, const char *stage, bool away);

/* Moves that record there, or back. */
bool aside_move_record(const char *capture, const char *stage, bool away, struct err *err);

#endif
